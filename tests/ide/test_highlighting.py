"""Words are shown as keywords where they are, and as names elsewhere."""

import re
from pathlib import Path

import pytest
from pygments.lexers import get_lexer_by_name
from pygments.token import Keyword, Name, Operator

from editors.generate import ROOT, texts
from scenic.compiler.parser import parse
from scenic.ide.highlighting import PATTERNS
from scenic.ide.pygments_lexer import ScenicLexer


def kinds(text: str) -> dict[str, object]:
    return {word: kind for kind, word in ScenicLexer().get_tokens(text) if word.strip()}


@pytest.mark.parametrize(
    ("text", "word", "kind"),
    [
        ("ego = new Object behind x", "behind", Operator.Word),
        ("behind = 3", "behind", Name),
        ("x = behind - 2", "behind", Name),
        ("x = behind if y else z", "behind", Name),
        ("ego = new Object facing directly away from x", "facing directly away from", Operator.Word),
        ("ego = new Object facing directly", "directly", Name),
        ("take brake, steer", "take", Keyword),
        ("take = 3", "take", Name),
        ("x.take(3)", "take", Name),
        ("behavior B():\n    wait", "wait", Keyword),
        ("    wait = 3", "wait", Name),
        ("behavior B():\n    pass", "B", Name.Class),
        ("x = 30 deg", "deg", Operator.Word),
        ("deg = 3", "deg", Name),
        ("do B() for 3 seconds", "seconds", Operator.Word),
        ("require always x", "always", Operator.Word),
        ("require x intersects y", "intersects", Operator.Word),
        ("x = new Object with width 3", "width", Name.Attribute),
        ("with open(x) as f: pass", "open", Name.Builtin),
        ("scenario S():\n    setup:\n        pass", "setup", Keyword),
        ("setup = 3", "setup", Name),
        ("match x:\n    case 3: pass", "match", Keyword),
        ("ego = Range(1, 2)", "ego", Name.Builtin.Pseudo),
        ("f'{30 deg}'", "deg", Operator.Word),
    ],
)
def test_words(text: str, word: str, kind: object) -> None:
    assert kinds(text)[word] is kind


@pytest.mark.parametrize("path", sorted((ROOT / "examples").rglob("*.scenic")), ids=lambda path: path.stem)
def test_nothing_is_lost(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert not parse(text).diagnostics
    assert "".join(word for _, word in ScenicLexer(stripnl=False, ensurenl=False).get_tokens(text)) == text


def test_pygments_finds_the_lexer() -> None:
    assert isinstance(get_lexer_by_name("scenic"), ScenicLexer)


def test_patterns_group_what_they_show() -> None:
    for pattern in PATTERNS:
        assert re.compile(pattern.regex).groups == len(pattern.categories), pattern


def test_generated_files_are_current() -> None:
    for name, text in texts().items():
        path = ROOT / name
        assert path.is_file(), f"{name} is missing: run `make generate`"
        assert path.read_text(encoding="utf-8") == text, f"{name} is stale: run `make generate`"
    drawn = {str(path.relative_to(ROOT)) for path in (ROOT / "docs" / "reference" / "syntax").glob("*.svg")}
    assert drawn <= texts().keys()
