"""The generator refuses grammars with dead or ambiguous parts, and what it makes of the others parses."""

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from grammar.generator import MODULES, GrammarError, generate, modules, read_grammar, read_grammar_text
from grammar.generator.analysis import Analysis

ROOT = Path(__file__).resolve().parents[2]
START = "@start file\n"

ARITHMETIC = """\
@start file
file: a=expression ENDMARKER { a }
expression["a sum"]:
    | a=expression '+' b=product { flat([a, b]) }
    | product
product:
    | a=product '*' b=power { words([a, b]) }
    | power
power:
    | a=atom '^' b=power { joined([a, b]) }
    | atom
atom:
    | '(' a=expression ')' { a }
    | a=NUMBER { texts[a] }
    | a=NAME { texts[a] }
"""


def check_refused(text: str, *parts: str) -> None:
    with pytest.raises(GrammarError) as caught:
        modules(read_grammar_text(text))
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize(
    ("rules", "parts"),
    [
        ("file: a ENDMARKER { 1 }\na: 'x' { 1 }\na: 'y' { 1 }\n", ["'a'", "twice"]),
        ("file: 'x' ENDMARKER { 1 }\na: 'y' { 1 }\n", ["no rule uses a"]),
        ("file: a ENDMARKER { 1 }\na: b { 1 } | 'y' { 2 }\n", ["'a'", "'b'", "not defined"]),
        ("file: a ENDMARKER { 1 }\na: 'x' { 1 } | 'x' 'y' { 2 }\n", ["'a'", "never reached", "'x' 'y'"]),
        ('file: a ENDMARKER { 1 }\na: b=NAME { 1 } | "y" { 2 }\n', ["'a'", "never reached"]),
        ("file: a ENDMARKER { 1 }\na: ('x' | 'y') { 1 } | 'z' { 3 } | 'y' 'z' { 2 }\n", ["never reached"]),
        ("file: a ENDMARKER { 1 }\na: 'x' { 1 } | 'x' { 1 }\n", ["'a'"]),
        ("file: a ENDMARKER { 1 }\na: 'x'?\n", ["'a'", "nothing"]),
        ("file: a ENDMARKER { 1 }\na: b 'x' { 1 } | 'y' { 1 }\nb: a 'z' { 1 }\n", ["left-recursive through"]),
        ("file: a ENDMARKER { 1 }\na: 'x'? a 'y' { 1 } | 'z' { 1 }\n", ["left-recursive behind"]),
        ("file: a ENDMARKER { 1 }\na: a 'x' { 1 } | 'z' { 1 }\n", ["'a'", "name"]),
        ("file: a ENDMARKER { 1 }\na: 'x' 'y'\n", ["'a'", "action"]),
        ("file: a ENDMARKER { 1 }\na: 'x' b='y'?\n", ["'a'", "None"]),
        ("file: a ENDMARKER { 1 }\na: b='x' { unknown(b) }\n", ["'a'", "'unknown'"]),
        ("file: a ENDMARKER { 1 }\na: b='x' { c }\n", ["'a'", "'c'"]),
        ("file: a ENDMARKER { 1 }\na: b='x' { Pass(value=b) }\n", ["Pass"]),
        ("file: a ENDMARKER { 1 }\na: b='x' { if }\n", ["no expression"]),
        ("file: a ENDMARKER { 1 }\na: 'x' { 1 } | \"x\" { 1 }\n", ["both hard and soft"]),
        ('file: a ENDMARKER { 1 }\na: "+" { 1 }\n', ["only words"]),
        ("file: NAME ENDMARKER { 1 }\nNAME: 'x' { 1 }\n", ["'NAME'"]),
        ("file: &&'x' ENDMARKER { 1 }\n", ["Forced"]),
        ("other: 'x' ENDMARKER { 1 }\n", ["'file'"]),
        ("file: 'x' ENDMARKER { 1 }\n)\n", ["notation"]),
    ],
)
def test_wrong_grammars_are_refused(rules: str, parts: list[str]) -> None:
    check_refused(START + rules, *parts)


def test_unknown_settings_are_refused() -> None:
    check_refused("@strat file\nfile: 'x' ENDMARKER { 1 }\n", "strat")
    check_refused("@start file\n@recover nothing\nfile: 'x' ENDMARKER { 1 }\n", "nothing")


def parse(grammar: str, words: str) -> Any:
    """Parse blank-separated tokens with both parsers made from a grammar."""
    read = read_grammar_text(grammar)
    texts = words.split()
    vocabulary = {
        **read.vocabulary.hard_keywords,
        **read.vocabulary.operators,
        **read.vocabulary.soft_keywords,
    }
    kinds = [vocabulary.get(text, 4 if text.isdigit() else 256) for text in texts] + [0] * 5
    places = list(range(len(kinds)))
    actions = SimpleNamespace(
        flat=lambda items: ("+", *items),
        words=lambda items: ("*", *items),
        joined=lambda items: ("^", *items),
    )
    lists = (kinds, [*texts, "", ""], places, places, places, places, actions)
    namespaces: list[dict[str, Any]] = []
    for name in ("parser", "recording"):
        namespaces.append({})
        exec(compile(modules(read)[name], name, "exec"), namespaces[-1])
    fast = namespaces[0]["build"](*lists)("file", 0)[0]
    slow, _, farthest, expected = namespaces[1]["build"](*lists, None)("file", 0)
    assert fast == slow
    return fast if fast is not None else (farthest, expected)


@pytest.mark.parametrize(
    ("words", "tree"),
    [
        ("a", "a"),
        ("a + b + c", ("+", ("+", "a", "b"), "c")),
        ("a + b * c", ("+", "a", ("*", "b", "c"))),
        ("a * b + c * d", ("+", ("*", "a", "b"), ("*", "c", "d"))),
        ("a ^ b ^ c * d", ("*", ("^", "a", ("^", "b", "c")), "d")),
        ("( a + b ) * 3 ^ ( c )", ("*", ("+", "a", "b"), ("^", "3", "c"))),
    ],
)
def test_ladders(words: str, tree: Any) -> None:
    assert parse(ARITHMETIC, words) == tree


def test_the_farthest_token_and_what_was_expected_there() -> None:
    kinds = read_grammar_text(ARITHMETIC).vocabulary.operators
    assert parse(ARITHMETIC, "a + ) b") == (2, {256, 4, kinds["("]})
    assert parse(ARITHMETIC, "( a b") == (2, {kinds["+"], kinds["*"], kinds["^"], kinds[")"]})
    assert parse(ARITHMETIC, ")") == (0, {"a sum"})


def test_ordered_choice_lookahead_cut_and_repetition() -> None:
    grammar = START + (
        "file: a=item+ ENDMARKER { [a] }\n"
        "item:\n"
        "    | \"let\" a=NAME '=' ~ b=NUMBER { ('let', texts[a], texts[b]) }\n"
        "    | \"let\" !'=' { ('let',) }\n"
        "    | '[' a=','.NUMBER+ b=','? ']' { ('list', [texts[x] for x in a], b) }\n"
        "    | a=NAME &('=' | NAME) { ('before', texts[a]) }\n"
        "    | a=NAME { ('name', texts[a]) }\n"
        "    | '=' { ('is',) }\n"
    )
    assert parse(grammar, "let x = 3") == [[("let", "x", "3")]]
    assert parse(grammar, "let 3")[0] == 1
    assert parse(grammar, "let let") == [[("let",), ("let",)]]
    assert parse(grammar, "x = y") == [[("before", "x"), ("is",), ("name", "y")]]
    assert parse(grammar, "[ 1 , 2 , ]") == [[("list", ["1", "2"], 4)]]
    assert parse(grammar, "[ 1 , 2 ]") == [[("list", ["1", "2"], None)]]
    # After the cut the second reading of `let` is not tried.
    assert isinstance(parse(grammar, "let x = y"), tuple)


def test_nested_choices_are_memoised() -> None:
    analysis = Analysis(
        read_grammar_text(
            START + "file: a=item ENDMARKER { [a] }\n"
            "item: '(' a=item ')' '!' { [a] } | '(' b=item ')' '?' { [b] } | pair '.' { 1 } | NAME { 2 }\n"
            "pair: '(' a=item ',' b=item ')' { [a, b] }\n"
        )
    )
    assert "item" in analysis.memoised


def test_the_grammar_of_scenic() -> None:
    grammar = read_grammar(ROOT / "grammar" / "scenic.gram")
    analysis = Analysis(grammar)
    assert len(grammar.vocabulary.hard_keywords) == 44
    ladder = analysis.ladder("expression")
    assert ladder[0] == "expression"
    assert ladder[-1] == "primary"
    # An ordinary name goes straight down the ladder.
    assert 256 in analysis.plain_starts("expression")[0]


def test_generation_is_deterministic_and_replaces_whole_files(tmp_path: Path) -> None:
    path = ROOT / "grammar" / "scenic.gram"
    generate(path, tmp_path / "new" / "folder")
    names = {each.name for each in (tmp_path / "new" / "folder").iterdir()}
    assert names == {"__init__.py", *(f"{name}.py" for name in MODULES)}
    made_before = ROOT / "scenic" / "compiler" / "_generated" / "parser.py"  # by another process
    assert (tmp_path / "new" / "folder" / "parser.py").read_text() == made_before.read_text()


def test_a_wrong_grammar_leaves_the_folder_alone(tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.gram"
    wrong.write_text(START + "file: 'x' ENDMARKER { 1 }\nunused: 'y' { 1 }\n")
    with pytest.raises(GrammarError):
        generate(wrong, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_command_says_what_is_wrong(tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path; import grammar.generator.__main__ as command; "
        f"command.ROOT = Path({str(tmp_path)!r}); sys.exit(command.main())"
    )
    (tmp_path / "grammar").mkdir()
    (tmp_path / "grammar" / "scenic.gram").write_text(START + "file: a ENDMARKER { 1 }\n")
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "'a'" in done.stderr
    assert "Traceback" not in done.stderr
