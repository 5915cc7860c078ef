"""``override``: new values for properties of an object, until the scenario that set them stops."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from scenic.language.errors import ScenicTypeError, SpecifierError
from scenic.runtime.description.definitions import Behavior, behavior_of
from scenic.runtime.dynamics.activations import Activation
from scenic.runtime.elements.resolution import resolution_of
from scenic.runtime.elements.specifiers import Specifier
from scenic.runtime.ground.context import here
from scenic.runtime.instances.objects import Object
from scenic.runtime.instances.properties import Finals, normalised
from scenic.runtime.values.lazy import resolve as settle
from scenic.runtime.values.values import describe

if TYPE_CHECKING:
    from scenic.runtime.dynamics.run import Run

__all__ = ["Overrides", "override_before", "refresh"]


class Overrides:
    """The overrides of one running scenario."""

    __slots__ = ("_before", "_run")

    def __init__(self, run: "Run") -> None:
        self._run = run
        self._before: dict[tuple[int, str], tuple[Any, Any]] = {}
        """The value before the first override, by object and property."""

    def apply(self, target: Any, specifiers: Sequence[Specifier]) -> None:
        """Give the properties that the specifiers claim new values.

        Raises `ScenicTypeError` if the target is no object, `SpecifierError` where the properties cannot be overridden.
        """
        for name, value in _values(target, specifiers, mode_2d=self._run.context.mode_2d).items():
            self._set(target, name, value)
        refresh(target)

    def _set(self, target: Object, name: str, value: Any) -> None:
        old = target.__dict__.get(name)
        if name == "behavior":
            value = behavior_of(value)
            if value is not None:
                Activation(self._run, value, target, self._run.current).start()
                self._run.note_agent(target)
            if (
                (id(target), name) in self._before
                and isinstance(old, Behavior)
                and old._activation is not None
            ):
                old._activation.stop()  # It was an override itself, and will not come back.
        self._before.setdefault((id(target), name), (target, old))
        target.__dict__[name] = value

    def revert(self) -> None:
        """Give everything its value from before the first override."""
        for (_, name), (target, old) in self._before.items():
            present = target.__dict__.get(name)
            if name == "behavior" and isinstance(present, Behavior) and present._activation is not None:
                present._activation.stop()
            target.__dict__[name] = old
            refresh(target)
        self._before = {}


def override_before(target: object, specifiers: Sequence[Specifier], *, mode_2d: bool) -> None:
    """``override`` in the set-up of the scenario that is compiled, which scenes are samples of.

    Raises what `Overrides.apply` does.
    """
    for name, value in _values(target, specifiers, mode_2d=mode_2d).items():
        target.__dict__[name] = behavior_of(value) if name == "behavior" else value
    refresh(target)


def refresh(obj: Any) -> None:
    """Compute again what a dynamic final property is made of."""
    finals = Finals.of(type(obj).scenic_properties)
    for entry in finals.builtin:
        obj.__dict__[entry.name] = entry.default(obj)
    finals.renew_own(obj)


def _values(target: object, specifiers: Sequence[Specifier], *, mode_2d: bool) -> dict[str, Any]:
    """Return the values, by property, that the specifiers of an `override` give to the object ``target``."""
    if not isinstance(target, Object):
        raise ScenicTypeError(f"`override`: expected an object, not {describe(target)}", span=here())
    properties = type(target).scenic_properties
    attributes = target.__dict__
    values: dict[str, Any] = {}
    for step in resolution_of(type(target), specifiers, mode_2d=mode_2d).steps:
        if step.default is not None:
            continue
        specifier = step.specifier(specifiers)
        for name in step.names:
            entry = properties.get(name)
            if entry is None and name not in attributes:
                raise SpecifierError(
                    f"there is no property {name!r} to override",
                    span=specifier.span,
                    help="an override changes properties that the object has",
                )
            if entry is not None and entry.dynamic:
                raise SpecifierError(
                    f"property {name!r} is dynamic and cannot be overridden: the simulator decides it",
                    span=specifier.span,
                )
        values_of_specifier = specifier.evaluate(target)
        values.update(
            (name, normalised(name, settle(values_of_specifier[name], target))) for name in step.names
        )
    return values
