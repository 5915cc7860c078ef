"""Pages made from the declarations of `scenic.language`: each directive shows one element, or all of a kind.

- ``specifier``, ``operator``, ``statement``, ``provided``: one of them, by its name; ``temporal``: all temporal operators.
- ``class``: the properties and attributes of a built-in class.
- ``diagnostics``: the pages of all diagnostics.
"""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from scenic.language.diagnostics import CODES
from scenic.language.explanations import explanation
from scenic.language.keywords import TEMPORAL_OPERATORS
from scenic.language.names import NAMES
from scenic.language.operators import OPERATORS, Operand
from scenic.language.properties import CLASSES
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS

__all__ = [
    "class_text",
    "diagnostics_text",
    "operator_text",
    "provided_text",
    "specifier_text",
    "statement_text",
]

_DIAGRAMS = Path(__file__).parents[1] / "reference" / "syntax"


def _operands(operands: Iterable[Operand]) -> str:
    rows = [
        f"| *{operand.name}* | {operand.type}{' (a number is an angle in radians)' if operand.angle else ''} "
        f"| {operand.default or ''} |"
        for operand in operands
    ]
    return "\n".join(["| operand | type | if left out |", "|---|---|---|", *rows, ""]) + "\n" if rows else ""


def specifier_text(name: str) -> str:
    """A specifier: its forms, what it means, what it gives with which priority, and what it needs."""
    entry = SPECIFIERS[name]
    text = [f"`{form}`\n" for form in entry.forms] + [f"{entry.documentation}\n"]
    properties = [
        f"`{item.property}` (priority {item.priority}{f', if {item.when}' if item.when else ''})"
        for item in entry.specifies
    ]
    if properties:
        text.append(f"*Gives* {', '.join(properties)}.\n")
    if entry.modifies:
        text.append(f"*May adjust* {_listed(entry.modifies)} that another specifier gives.\n")
    if entry.needs:
        text.append(f"*Needs* {_listed(entry.needs)} of the new object.\n")
    return "\n".join(text) + "\n" + _operands(entry.operands)


def operator_text(name: str) -> str:
    """An operator: its forms, what it means, its result and its operands."""
    entry = OPERATORS[name]
    result = f"*Result:* {entry.result}{', an angle in radians' if entry.angle else ''}.\n"
    return "\n".join(
        [
            *(f"`{form}`\n" for form in entry.forms),
            entry.documentation + "\n",
            result,
            _operands(entry.operands),
        ]
    )


def statement_text(node: str) -> str:
    """A statement: its diagram, its forms, what it means and where it can stand."""
    entry = STATEMENTS[node]
    name = re.sub(r"[^a-z]+", "-", entry.title).strip("-")
    drawn = (_DIAGRAMS / f"{name}.svg").exists()
    diagram = f"```{{image}} syntax/{name}.svg\n:alt: The syntax of {entry.title}\n```\n\n" if drawn else ""
    places = ", ".join(sorted(place.value for place in entry.places))
    forms = "".join(f"- `{form}`\n" for form in entry.forms)
    return f"{diagram}{forms}\n{entry.documentation}\n\n*Where:* {places}.\n"


def provided_text(name: str) -> str:
    """A name that is always in scope: how it is called, and what it is."""
    entry = NAMES[name]
    return f"`{entry.signature}`\n\n{entry.documentation}\n"


def temporal_text(_: str) -> str:
    """All temporal operators, as a table."""
    rows = [
        f"| `{'`, `'.join(entry.forms)}` | {entry.documentation} |" for entry in TEMPORAL_OPERATORS.values()
    ]
    return "\n".join(["| operator | meaning |", "|---|---|", *rows, ""])


def class_text(name: str) -> str:
    """A built-in class: its own properties with types and defaults, and its derived attributes."""
    entry = CLASSES[name]
    text = [
        entry.documentation + (f" It has all properties of `{entry.base}`, too." if entry.base else ""),
        "",
    ]
    text += ["| property | type | default | meaning |", "|---|---|---|---|"]
    for item in entry.properties:
        flags = [word for word in ("dynamic", "final", "additive") if getattr(item, word)]
        note = f" *{', '.join(flags).capitalize()}.*" if flags else ""
        text.append(f"| `{item.name}` | {item.type} | {_code(item.default)} | {item.documentation}{note} |")
    text += ["", "| attribute | type | meaning |", "|---|---|---|"]
    text += [
        f"| `{item.name}{'()' if item.is_method else ''}` | {item.type} | {item.documentation} |"
        for item in entry.attributes
    ]
    return "\n".join(text) + "\n"


def diagnostics_text(_: str) -> str:
    """Return the pages of all diagnostics, one after the other, each with its code as the target of links."""
    return "\n".join(_page(code) for code in CODES)


def _page(code: str) -> str:
    """The page of a code as a section: its parts have no headings of their own."""
    head, *lines = explanation(code).text.splitlines()
    title = head.removeprefix("# ")
    shown, fenced = [], False
    for line in lines:
        fenced ^= line.startswith("```")
        shown.append(f"**{line[3:]}**" if line.startswith("## ") and not fenced else line)
    return f"({code.lower()})=\n### {title}\n" + "\n".join(shown) + "\n"


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _code(text: str) -> str:
    """A default as code, unless it is given in words."""
    return text if re.match(r"(a|an|no|the|parent\w+ turned)\b", text) else f"`{text}`"


class _Declared(SphinxDirective):
    """Shows the text that a function returns for an element."""

    optional_arguments = 1
    final_argument_whitespace = True
    tell: Any = None

    def run(self) -> list[nodes.Node]:
        """The text of the element, as part of the page."""
        name = " ".join(self.arguments)
        text = type(self).tell(name)
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def setup(app: Sphinx) -> dict[str, Any]:
    """Add a directive for each kind of element."""
    tellers = {
        "specifier": specifier_text,
        "operator": operator_text,
        "statement": statement_text,
        "provided": provided_text,
        "temporal": temporal_text,
        "class": class_text,
        "diagnostics": diagnostics_text,
    }
    for name, tell in tellers.items():
        app.add_directive(name, type(name, (_Declared,), {"tell": staticmethod(tell)}))
    return {"version": "1", "parallel_read_safe": True}
