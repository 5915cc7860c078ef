"""The grammars for constrained decoding accept what the parser accepts, in engines that others wrote."""

import json
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from fuzz.draws import RandomDraws
from fuzz.grammar import make_program
from fuzz.layout import lay_out as lay_out_pieces
from scenic.cli.grammar import grammar
from scenic.compiler.generated import HARD_KEYWORDS
from scenic.compiler.parser import parse
from scenic.constrained import FORMATS, grammar_text
from scenic.constrained.grammar_rules import read_rules
from scenic.constrained.items import TextChoice, TextMany, TextOptional, TextRow, Use, Variant
from scenic.constrained.layout import lay_out
from scenic.constrained.terminals import letters

ROOT = Path(__file__).parents[2]


@cache
def _matcher(world: str | None) -> Any:
    """The matcher that llguidance makes of a grammar, for a model whose tokens are single bytes."""
    llguidance = pytest.importorskip("llguidance")

    class Bytes:
        eos_token_id = 256
        bos_token_id = None
        tokens = (*(bytes([each]) for each in range(256)), b"<end>")
        special_token_ids = (256,)

        def __call__(self, text: bytes | str) -> list[int]:
            return list(text.encode() if isinstance(text, str) else text)

    tokenizer = llguidance.LLTokenizer(llguidance.TokenizerWrapper(Bytes()))
    matcher = llguidance.LLMatcher(
        tokenizer, llguidance.LLMatcher.grammar_from_lark(grammar_text("lark", world))
    )
    assert not matcher.is_error(), matcher.get_error()
    return matcher


def _refused(text: str, world: str | None = None) -> str | None:
    """The text before the place where the engine refuses one; ``None`` if it accepts it."""
    matcher = _matcher(world).deep_copy()
    data = text.encode()
    read = matcher.try_consume_tokens(list(data))
    if read == len(data) and matcher.is_accepting():
        return None
    return data[max(0, read - 60) : read].decode(errors="replace")


@pytest.mark.parametrize("folder", ["basics", "driving", "indoor", "drones"])
def test_examples_are_accepted(folder: str) -> None:
    for path in sorted((ROOT / "examples" / folder).glob("*.scenic")):
        assert _refused(path.read_text(encoding="utf-8")) is None, path


def test_sentences_are_accepted() -> None:
    """Texts that another generator makes of the grammar of the parser, as they are usually laid out."""
    count = 0
    for seed in range(60):
        text = lay_out_pieces(make_program(RandomDraws(seed)).pieces)
        if not parse(text).diagnostics:
            count += 1
            assert _refused(text) is None, text
    assert count > 40


@pytest.mark.parametrize(
    "text",
    [
        "x = [1,  # a comment\n\n  2]\n",
        "if (x\n    or y):\n    pass\n\n\n# end",
        "x = f'{y:>{10}} {{}} {z!r}' f\"\" f'''a'b'''\n",
        "visible = 3\nbehavior = visible\n",
        "require(x)\nassert(not(y))\n",
        "",
        "\n# nothing\n",
    ],
)
def test_layout_is_accepted(text: str) -> None:
    assert not parse(text).diagnostics
    assert _refused(text) is None


@pytest.mark.parametrize(
    "text",
    [
        "x = 1 +\n",
        "x = (1\n",
        "f() = 3\n",
        "new Object at 1 facing 2\n",
        "if x:\npass\n",
        "   x = 3\n",
        "def f(a=1, b): pass\n",
        "f(a=1, b)\n",
        "require x y\n",
        "x = y ifz else w\n",
        "for x in y\n    pass\n",
        "ego = new Object facing\n",
        "with = 3\n",
        "x = 'a\n",
    ],
)
def test_mistakes_are_refused(text: str) -> None:
    assert parse(text).diagnostics
    assert _refused(text) is not None


@pytest.mark.parametrize(
    ("world", "right", "wrong"),
    [
        ("driving", "ego = new Car", "ego = new Tree"),
        ("driving", "ego = new MyCar", "ego = new YourCar"),
        ("driving", "new Car with behavior FollowLaneBehavior(3)", "new Car with behavior FollowLane()"),
        (
            "driving",
            "new Car with behavior Uniform(WalkForwardBehavior(), MyWalk())",
            "new Car with behavior 3",
        ),
        ("driving", "new Car with behaviors FollowLane()", "model scenic.domains.drive.model"),
        (
            "driving",
            "new Car at x, with speed 3, facing toward y",
            "new Car at x, with speed, facing toward y",
        ),
        ("driving", "behavior MyDrive():\n    do FollowLaneBehavior() for 3 seconds", "do Drive()"),
        ("driving", "do choose {MyDrive(): 1, TurnBehavior(x): 2}", "do choose {Drive(): 1}"),
        ("carla", 'new Car with blueprint "vehicle.audi.a2"', 'new Car with blueprint "vehicle.audi.a1"'),
        ("carla", "model scenic.simulators.carla.model\nnew Prop", "model scenic.domains.driving.model"),
    ],
)
def test_worlds_have_their_names_and_no_others(world: str, right: str, wrong: str) -> None:
    assert not parse(right).diagnostics
    assert _refused(right, world) is None
    assert _refused(wrong, world) is not None


def test_a_world_that_there_is_not() -> None:
    shown = CliRunner().invoke(grammar, ["--world", "drivng"])
    assert shown.exit_code == 2
    assert "Did you mean 'driving'?" in shown.output


def test_each_format_defines_what_it_uses() -> None:
    """Each notation has the same rules; in JSON, the rules of tokens."""
    runner = CliRunner()
    for notation in FORMATS:
        shown = runner.invoke(grammar, ["--format", notation])
        assert shown.exit_code == 0
        assert shown.output == grammar_text(notation)
    assert json.loads(grammar_text("json", "driving"))["world"]["module"] == "scenic.domains.driving.model"
    data = json.loads(grammar_text("json"))
    assert set(data["keywords"]) == set(HARD_KEYWORDS)
    assert set(_rules_in(data["rules"])) <= data["rules"].keys()
    for notation, world in (("gbnf", None), ("ebnf", "carla")):
        lines = [line for line in grammar_text(notation, world).splitlines() if not line.startswith("#")]
        defined = [line.split(" ::= ")[0] for line in lines]
        assert len(defined) == len(set(defined))
        # Without literals and classes of characters only names and marks remain.
        rest = re.sub(r'"(?:\\.|[^"\\])*"|\[(?:\\.|[^\]\\])*\]', "", "\n".join(lines))
        assert set(re.findall(r"[\w-]+", rest)) - {"root"} == set(defined) - {"root"}


def test_no_rule_begins_with_itself() -> None:
    """The parser of llama.cpp would not come to an end."""
    rules = lay_out(read_rules(), "file").rules
    begins = {variant: set(_beginnings(rows)) for variant, rows in rules.items()}
    for variant in rules:
        reached, pending = set(), list(begins[variant])
        while pending:
            other = pending.pop()
            if other not in reached:
                reached.add(other)
                pending += begins[other]
        assert variant not in reached


def _beginnings(rows: tuple[TextRow, ...]) -> Iterator[Variant]:
    for row in rows:
        for item in row:
            match item:
                case Use():
                    yield item.variant
                case TextOptional() | TextMany():
                    yield from _beginnings((item.row,))
                case TextChoice():
                    yield from _beginnings(item.rows)
                case _:
                    pass
            if not isinstance(item, TextOptional):
                break


def _rules_in(data: Any) -> Any:
    match data:
        case {"rule": str(name)}:
            yield name
        case dict():
            for each in data.values():
                yield from _rules_in(each)
        case list():
            for each in data:
                yield from _rules_in(each)


def test_letters_are_those_of_names() -> None:
    """Every character of a name is in the class, and no character of text that is none."""
    for first, prefix in ((True, ""), (False, "a")):
        pattern = re.compile(f"[{letters(first=first)}]")
        for character in "éßλжあ漢𝐱ª":
            assert pattern.match(character)
        for character in "\u00a0\u2028\u200b“−😀€":
            assert not pattern.match(character), repr(character)
        assert all(
            pattern.match(chr(code)) for code in range(0x80, 0x3000) if (prefix + chr(code)).isidentifier()
        )
