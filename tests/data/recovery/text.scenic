"""
Strings of all kinds: what has quotes in it is hard to recover.
"""
TITLE = 'The "first" scenario'
NOTE = "it's a note"
LONG = """Several lines
of text, with 'quotes' and "quotes"
and a # that is no comment
"""
RAW = r"C:\path\to\file"
BYTES = b"bytes \x00"

def label(name, value, unit="m"):
    """A label for a value.

    It has several lines: this one, and
    the next.
    """
    head = f"{name.upper()}: "
    tail = f"{value:.3f} {unit}"
    if value < 0:
        tail = f"({tail})"
    return head + tail

def table(rows):
    lines = [
        f"{index:3d} | {name:<10} | {value!r}"
        for index, (name, value) in enumerate(rows)
    ]
    return "\n".join(lines)

class Sign(Object):
    text: "STOP"
    width: len(self.text) * 0.1
    height: 0.5
    colour: "red"

SIGNS = {
    "stop": "STOP",
    "yield": "GIVE WAY",
    'end': 'END',
}

param title = TITLE
param note = NOTE, length = len(LONG)

ego = new Object at (0, 0, 0), with name f"ego {TITLE}"
for key, text in SIGNS.items():
    sign = new Sign at (len(key), 5, 1),
        with text text,
        with name f"sign {key}"
    print(label(key, len(text)), end="; ")

message = (
    "a long message that "
    "goes on, "
    f"and has {len(SIGNS)} signs"
)
print(table(SIGNS.items()))
print(message, RAW, BYTES)
require ego.name != "nobody" as "named"
record ego.position as "where it is"
