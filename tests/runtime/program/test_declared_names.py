"""What is declared of names that programs find in scope is so."""

import functools
import inspect
from pkgutil import resolve_name

from scenic.language.names import NAMES
from scenic.runtime.program.builtins import language_names


def test_every_implementation_is_found_and_has_the_declared_name() -> None:
    found = language_names()
    assert set(found) == {name for name, declared in NAMES.items() if declared.home is not None}
    for name, value in found.items():
        assert value is resolve_name(str(NAMES[name].home))


def test_complete_signatures_have_the_parameters_of_the_implementation() -> None:
    wrong = []
    for name, declared in NAMES.items():
        if (
            not (declared.is_complete or declared.further)
            or declared.home is None
            or "{" in declared.signature
        ):
            continue
        implementation = language_names()[name]
        if declared.further and isinstance(implementation, type):
            implementation = functools.partial(implementation.__init__, None)
        parameters = inspect.signature(implementation).parameters.values()
        optional = [f"{each.name}=" if each.default is not each.empty else each.name for each in parameters]
        inside = declared.signature.partition("(")[2].removesuffix(")").split(", ")
        inside += declared.further.split(", ")
        shown = [f"{part.partition('=')[0]}{'=' * ('=' in part)}" for part in inside if part not in ("", "*")]
        # What takes no keyword may call its parameter as it reads best.
        if any(each.kind is not each.POSITIONAL_ONLY for each in parameters) and shown != optional:
            wrong.append(f"{declared.signature}: {optional}")
    assert not wrong


def test_types_and_angles_are_of_parameters() -> None:
    for declared in NAMES.values():
        assert set(declared.angles) <= set(declared.parameters)
        assert len(declared.types) <= len(declared.parameters)
