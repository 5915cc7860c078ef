"""What the language has and this version does not build is refused with SC900 at its place, and in no other way."""

from collections.abc import Iterator

import scenic
from scenic.failures import diagnose
from scenic.language.diagnostics import Diagnostic
from scenic.language.names import NAMES
from scenic.language.support import refused_features
from scenic.runtime.description.outcome import Program
from scenic.runtime.program.builtins import builtin_names
from tests.each import each


def test_nothing_that_is_declared_is_refused() -> None:
    assert list(refused_features()) == []
    provided = builtin_names(Program(), "x.scenic", lambda *_: None)
    assert all(name in provided for name in NAMES)


def parts() -> Iterator[tuple[str, str]]:
    """Attributes and methods that the declarations promise, used on instances and values."""
    from scenic.language.properties import CLASSES, attributes_of, properties_of

    arguments = {
        "relativize": "(1, 2)", "relativePosition": "(1, 2)", "distancePast": "(1, 2)", "distanceTo": "(1, 2)",
        "containsPoint": "(1, 2)", "intersects": "ego", "canSee": "(1, 2)",
    }  # fmt: skip
    for cls in CLASSES:
        for name in properties_of(cls):
            yield cls, name
        for name, attribute in attributes_of(cls).items():
            yield cls, f"{name}({arguments.get(name, '')})" if attribute.is_method else name


@each(parts())
def test_what_instances_have_works_or_is_refused(asked: tuple[str, str]) -> None:
    cls, part = asked
    text = f"ego = new Object at (9, 9)\nx = new {cls} at (Range(0, 1), 0), with allowCollisions True\ny = x.{part}\n"
    found = mistake(text)
    assert found is None or (found.code, found.span is not None and found.span.line) == ("SC900", 3), found


def mistake(text: str) -> Diagnostic | None:
    try:
        scenic.scenarioFromString(text).sample(1, seed=0)
    except Exception as error:
        found = diagnose(error)
        if found is None:
            raise
        return found
    return None
