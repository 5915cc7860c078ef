"""The checks against independent judges: Python's own evaluation of literals, and its calls."""

import ast
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from scenic.compiler.check import check_text
from scenic.compiler.checks.conditions import truth
from scenic.language.source import Source

FOLDER = Path(__file__).parents[2] / "data" / "checks" / "lint"
TEXTS = [case.read_text(encoding="utf-8") for case in sorted(FOLDER.glob("*.scenic"))]

LITERALS = st.sampled_from(
    ["0", "1", "2.5", "-1", "''", "'a'", "None", "True", "False", "()", "[]", "[0]", "(0, 1)"]
)
CONDITIONS = st.recursive(
    LITERALS,
    lambda inner: st.one_of(
        st.tuples(st.just("not "), inner).map("".join),
        st.tuples(inner, st.sampled_from([" and ", " or "]), inner).map(lambda parts: f"({''.join(parts)})"),
        st.tuples(
            st.sampled_from("012"), st.sampled_from(["<", "==", ">=", "!="]), st.sampled_from("012")
        ).map(lambda parts: f"({' '.join(parts)})"),
    ),
    max_leaves=6,
)


@given(CONDITIONS)
def test_what_is_known_of_a_condition_is_so(text: str) -> None:
    known = truth(ast.parse(text, mode="eval").body)
    assert known in (None, bool(eval(text)))


NAMES = st.sampled_from("abcd")


@st.composite
def signatures(draw: st.DrawFn) -> str:
    """The parameters of a function, of every kind."""
    names = draw(st.permutations("abcd"))[: draw(st.integers(0, 4))]
    cut = draw(st.integers(0, len(names)))
    positional, keyword = names[:cut], names[cut:]
    defaults = draw(st.integers(0, len(positional)))
    parts = [
        name if index < len(positional) - defaults else f"{name}=0" for index, name in enumerate(positional)
    ]
    if draw(st.booleans()) and parts:
        parts.insert(draw(st.integers(1, len(parts))), "/")
    if draw(st.booleans()):
        parts.append("*rest")
    elif keyword:
        parts.append("*")
    required = draw(st.lists(st.booleans(), min_size=4, max_size=4))
    parts += [name if bare else f"{name}=0" for name, bare in zip(keyword, required, strict=False)]
    if draw(st.booleans()):
        parts.append("**others")
    return ", ".join(parts)


@given(signatures(), st.integers(0, 4), st.lists(NAMES, unique=True, max_size=3))
def test_arguments_fit_where_python_takes_them(parameters: str, count: int, keywords: list[str]) -> None:
    scope: dict[str, object] = {}
    exec(f"def f({parameters}): pass", scope)
    function = scope["f"]
    assert callable(function)
    arguments = ", ".join([*["1"] * count, *(f"{name}=1" for name in keywords)])
    try:
        function(*[1] * count, **dict.fromkeys(keywords, 1))
    except TypeError:
        fits = False
    else:
        fits = True
    found = check_text(f"def f({parameters}): pass\nf({arguments})\n", filename="f")
    assert ("SC211" not in {item.code for item in found}) is fits


@settings(deadline=None)  # Some texts take long, and the machine may be busy.
@given(
    st.sampled_from(TEXTS), st.lists(st.tuples(st.integers(0, 60), st.integers(0, 60)), max_size=4), st.data()
)
def test_nothing_raises_on_nonsense(text: str, moves: list[tuple[int, int]], data: st.DataObject) -> None:
    lines = text.split("\n")
    for source, target in moves:
        line = lines[source % len(lines)]
        lines.insert(
            target % len(lines), data.draw(st.sampled_from([line, line.strip(), line[: len(line) // 2]]))
        )
    nonsense = "\n".join(lines)
    places = Source(nonsense, "f").lines
    for item in check_text(nonsense, filename="f"):
        spans = [item.span, *(label.span for label in item.labels)]
        spans += [edit.span for edit in item.fix.edits] if item.fix is not None else []
        for span in spans:
            assert span is not None
            assert 1 <= span.line <= span.end_line <= len(places)
            assert span.end_column <= len(places[span.end_line - 1]) + 1
