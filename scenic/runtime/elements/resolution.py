"""The choice of the specifier that decides each property, and the building of an instance (section 6.1 of the specification)."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from inspect import getattr_static
from typing import Any

from scenic.dataclass import dataclass
from scenic.language.errors import InvalidScenarioError, Located, ScenicValueError, SpecifierError
from scenic.language.spans import Span
from scenic.language.spelling import nearest_property
from scenic.runtime.elements.specifiers import Specifier, kind_of_specifier
from scenic.runtime.ground.context import here, warn
from scenic.runtime.instances.objects import TWO_D_DEFAULTS, Object, Point, Yielding
from scenic.runtime.instances.properties import Finals, Property, normalised
from scenic.runtime.shapes.shapes import BoxShape
from scenic.runtime.values.lazy import MEMO, reads_of
from scenic.runtime.values.lazy import resolve as settle
from scenic.runtime.values.values import Orientation, Vector, is_number


@dataclass(frozen=True, slots=True, eq=False)
class ResolutionStep:
    """One specifier's turn: which of its values are taken.

    ``number`` is its place among the specifiers of the statement; those of defaults come with the step.
    """

    number: int | None
    default: Specifier | None
    names: tuple[str, ...]
    modifies: frozenset[str]
    """The names, among ``names``, whose value another specifier has given before."""
    builtin: Callable[[Any], Any] | None = None
    """The default, where it is the language's own: it is never lazy, and always fits its property."""

    def specifier(self, given: Sequence[Specifier]) -> Specifier:
        """Return the specifier, ``given`` those of the statement."""
        if self.default is not None:
            return self.default
        assert self.number is not None
        return given[self.number]


@dataclass(frozen=True, slots=True)
class SpecifierResolution:
    """Specifiers in the order in which to evaluate them, with what is taken of each.

    It depends on the kinds of the specifiers alone, not on their values: a class keeps its resolutions.
    """

    steps: tuple[ResolutionStep, ...]
    """All but those of ``constants``."""
    constants: Mapping[str, Any]
    """Properties whose defaults are the same for every instance, as instances store them."""
    providers: Mapping[str, ResolutionStep]
    """The specifier whose value of a property the others read: its modifier if it has one, else its owner."""
    names: tuple[str, ...]
    """All properties, those of the class first."""
    given: tuple[str, ...]
    """The properties that the program gives, by a specifier or in a class of its own."""
    is_doubtful: bool
    """True if a name looks misspelt, which causes a warning each time."""

    def provider(self, name: str, reader: Specifier) -> ResolutionStep:
        """Return the specifier that provides a property which ``reader`` reads."""
        provider = self.providers.get(name)
        if provider is None:
            raise SpecifierError(
                f"{reader} needs property {name!r}, which nothing provides",
                span=reader.span,
                help=f"give the class a default for it, or the object a value: `with {name} ...`",
            )
        return provider


_DIRECTIONS = frozenset({"heading", "orientation"})

_CHECKED = frozenset({"width", "length", "height", "shape"})

_PLAIN = frozenset({bool, int, float, str, type(None), Vector, Orientation})
"""Types of values that are never lazy and hold nothing that is."""


def build(cls: type[Point], specifiers: Sequence[Specifier], *, mode_2d: bool = False) -> Any:
    """Return a new instance of ``cls``.

    Raises `SpecifierError` where the specifiers do not fit together or to the class, `ScenicTypeError` and
    `ScenicValueError` where a value does not fit its property.
    """
    resolution = resolution_of(cls, specifiers, mode_2d=mode_2d)
    instance = cls._make({})
    values = instance.__dict__
    values.update(resolution.constants)
    finished_steps: set[ResolutionStep] = set()
    is_object = issubclass(cls, Object)

    def evaluate(step: ResolutionStep) -> None:
        if step in finished_steps:
            return
        finished_steps.add(step)
        if step.builtin is not None:
            (name,) = step.names
            # A lazy value may need this default before its turn.
            for dependency in cls.scenic_properties[name].dependencies:
                if dependency not in values and dependency in resolution.providers:
                    evaluate(resolution.providers[dependency])
            values[name] = normalised(name, step.builtin(instance))
            return
        specifier = step.specifier(specifiers)
        function = specifier.modify if step.modifies and specifier.modify else specifier.evaluate
        try:
            values_of_step = function(instance)
            for name in sorted(_reads(values_of_step, step.names)):
                # A default that is lazy, which shows only when it is evaluated.
                provider = resolution.provider(name, specifier)
                demand(provider)
                if name not in values:
                    raise _circle([specifier, provider.specifier(specifiers)])
            for name in step.names:
                value = values_of_step[name]
                if type(value) not in _PLAIN:
                    value = settle(value, instance)
                value = normalised(name, value)
                if is_object and mode_2d and name == "position":
                    value = normalised(name, (value.x, value.y, 0))  # before others read it
                values[name] = value
                if is_object and name in _CHECKED:
                    _check_value(name, value, mode_2d=mode_2d)
        except Located as error:
            if not specifier.is_default:
                error.span = specifier.span or error.span
            raise

    def demand(step: ResolutionStep) -> None:
        """Evaluate a step before its turn, after those that it depends on."""
        if step in finished_steps:
            return
        for name in sorted(step.specifier(specifiers).dependencies):
            if name not in values and name in resolution.providers:
                demand(resolution.providers[name])
        evaluate(step)

    for step in resolution.steps:
        evaluate(step)
    values.pop(MEMO, None)
    values["_names"] = resolution.names
    values["_given"] = resolution.given
    if mode_2d:
        values["_planar"] = True  # how it sees
    return instance


def _reads(offered: Mapping[str, object], names: Sequence[str]) -> frozenset[str]:
    """Return the properties that lazy values among those offered read."""
    lazy = [value for name in names if type(value := offered[name]) not in _PLAIN]
    return reads_of(lazy) if lazy else frozenset()


def resolution_of(cls: type[Point], specifiers: Sequence[Specifier], *, mode_2d: bool) -> SpecifierResolution:
    """Resolve specifiers as `resolve` does, but only once for each class and list of specifiers."""
    kinds = tuple(
        [
            item.kind or kind_of_specifier(item.name, item.priorities, item.dependencies, item.modifiable)
            for item in specifiers
        ]
    )
    resolutions = cls._resolutions
    resolution = resolutions.get((mode_2d, kinds))
    if resolution is None:
        resolution = resolve(cls, specifiers, class_defaults(cls, mode_2d=mode_2d))
        if not resolution.is_doubtful:
            resolutions[mode_2d, kinds] = resolution
    return resolution


def class_defaults(cls: type[Point], *, mode_2d: bool) -> dict[str, Property]:
    """Return the properties of a class, with the defaults of the mode."""
    properties = dict(cls.scenic_properties)
    if mode_2d and issubclass(cls, Object):
        for name, definition in TWO_D_DEFAULTS.items():
            entry = properties[name]
            if entry.definitions[0].is_builtin:
                properties[name] = Property(name, (definition,), entry.additive, entry.dynamic, entry.final)
    return properties


def _check(cls: type[Point], specifiers: Sequence[Specifier], properties: Mapping[str, Property]) -> bool:
    """Raise `SpecifierError` for what no specifier may specify; returns whether a property of Python's is doubtful."""
    is_doubtful = False
    for specifier in specifiers:
        circular_names = specifier.dependencies & specifier.priorities.keys()
        if circular_names:
            raise SpecifierError(
                f"{specifier} specifies {_quoted(circular_names)} and depends on it at the same time",
                span=specifier.span,
            )
        for name in specifier.priorities:
            is_doubtful |= _check_property(cls, name, specifier, properties)
    return is_doubtful


def _claims(
    specifiers: Sequence[Specifier], properties: Mapping[str, Property]
) -> tuple[dict[str, Specifier], dict[str, Specifier]]:
    """Return by property the specifier, or the default, that provides it, and the one that modifies it."""
    claims: dict[str, Specifier] = {}
    modifiers: dict[str, Specifier] = {}
    for specifier in specifiers:
        if not specifier.modifiable:
            for name, priority in specifier.priorities.items():
                _claim(claims, name, specifier, priority)
    for specifier in specifiers:
        if specifier.modifiable:
            _claim_or_modify(claims, modifiers, specifier)
    for name, entry in properties.items():
        if name not in claims:
            claims[name] = _default_specifier(name, entry)
    return claims, modifiers


def resolve(
    cls: type[Point], specifiers: Sequence[Specifier], properties: Mapping[str, Property]
) -> SpecifierResolution:
    """Decide who provides what, and in which order."""
    _reject_duplicates(specifiers)
    for name, entry in properties.items():
        if _is_taken(cls, name):
            raise _clash(cls, name, entry.definitions[0].span)
    is_doubtful = _check(cls, specifiers, properties)
    claims, modifiers = _claims(specifiers, properties)
    owns = _by_specifier(claims)
    modifies = _by_specifier(modifiers)
    numbers = {specifier: number for number, specifier in enumerate(specifiers)}
    steps = {
        specifier: ResolutionStep(
            numbers.get(specifier),
            None if specifier in numbers else specifier,
            tuple(sorted(owns.get(specifier, frozenset()) | modifies.get(specifier, frozenset()))),
            modifies.get(specifier, frozenset()),
            None if specifier in numbers else _builtin_default(properties, next(iter(specifier.priorities))),
        )
        for specifier in _topological(owns, modifies, claims, modifiers)
    }
    constants = _constants(cls, steps.values(), properties)
    return SpecifierResolution(
        tuple(step for step in steps.values() if step.default is None or step.names[0] not in constants),
        constants,
        {name: steps[specifier] for name, specifier in {**claims, **modifiers}.items()},
        tuple(dict.fromkeys([*cls.scenic_properties, *claims])),
        tuple(
            name
            for name, specifier in {**claims, **modifiers}.items()
            if specifier in numbers or not properties[name].definitions[0].is_builtin
        ),
        is_doubtful,
    )


def _reject_duplicates(specifiers: Sequence[Specifier]) -> None:
    seen: set[str] = set()
    for specifier in specifiers:
        if specifier.name in seen:
            raise SpecifierError(
                f"{specifier} is given twice", span=specifier.span, help="remove one of the two"
            )
        seen.add(specifier.name)


def _check_property(
    cls: type[Point], name: str, specifier: Specifier, properties: Mapping[str, Property]
) -> bool:
    """Raise an error for a property that cannot be specified; return whether its name looks misspelt, with a warning if so."""
    if name in properties:
        if properties[name].final:
            hint = None
            if name == "heading":
                hint = "use `facing`, or compile in 2D mode (`--2d`) to set headings"
            elif name == "orientation":
                hint = "use `facing`, or set `yaw`, `pitch`, `roll` or `parentOrientation`"
            raise SpecifierError(
                f"property {name!r} cannot be directly specified", span=specifier.span, help=hint
            )
    elif _is_taken(cls, name):
        raise _clash(cls, name, specifier.span)
    elif (similar_name := nearest_property(name, properties)) is not None:
        warn(
            f"{cls.__name__} has no property {name!r}, which is now created",
            code="SC300",
            span=specifier.span,
            help=f"did you mean {similar_name!r}?",
        )
        return True
    return False


def _is_taken(cls: type[Point], name: str) -> bool:
    """Return whether a class has an attribute that no property may replace."""
    return hasattr(cls, name) and not isinstance(getattr_static(cls, name), Yielding)


def _clash(cls: type[Point], name: str, span: Span | None) -> SpecifierError:
    return SpecifierError(
        f"{name!r} is an attribute of {cls.__name__} and cannot be a property",
        span=span,
        help="choose another name",
    )


def _claim(claims: dict[str, Specifier], name: str, specifier: Specifier, priority: int) -> None:
    present = claims.get(name)
    if present is None or priority < present.priorities[name]:
        claims[name] = specifier
    elif priority == present.priorities[name]:
        raise SpecifierError(
            f"property {name!r} is specified twice with the same priority: by {present} and by {specifier}",
            span=specifier.span,
            help="remove one of the two specifiers",
        )


def _claim_or_modify(
    claims: dict[str, Specifier], modifiers: dict[str, Specifier], specifier: Specifier
) -> None:
    for name, priority in specifier.priorities.items():
        present = claims.get(name)
        if present is None or priority < present.priorities[name]:
            claims[name] = specifier
        elif name in specifier.modifiable:
            if name in modifiers:
                raise SpecifierError(
                    f"property {name!r} is modified twice: by {modifiers[name]} and by {specifier}",
                    span=specifier.span,
                )
            modifiers[name] = specifier
        elif priority == present.priorities[name] == 1:
            _claim(claims, name, specifier, priority)


def _default_specifier(name: str, entry: Property) -> Specifier:
    return Specifier(
        f"default of {name}",
        {name: 10},
        entry.dependencies,
        lambda instance: {name: entry.default(instance)},
        site=entry.definitions[0].span,
        is_default=True,
    )


def _builtin_default(properties: Mapping[str, Property], name: str) -> Callable[[Any], Any] | None:
    """Return the function that computes a property's default, or ``None`` if a class of the program defines the default."""
    entry = properties[name]
    if not all(definition.is_builtin for definition in entry.definitions):
        return None
    return entry.default if entry.additive else entry.definitions[0].value


def _constants(
    cls: type[Point], steps: Iterable[ResolutionStep], properties: Mapping[str, Property]
) -> dict[str, Any]:
    """Return the built-in defaults that are the same for every instance: those that read nothing but one another.

    ``steps`` are in the order in which they are evaluated.
    """
    constants: dict[str, Any] = {}
    for step in steps:
        if step.default is None:
            continue
        (name,) = step.names
        entry = properties[name]
        definition = entry.definitions[0]
        if entry.additive or not definition.is_builtin or not constants.keys() >= entry.dependencies:
            continue
        value = definition.compute(cls._make(constants))
        # Other values may be changed in place, and must not be shared.
        if type(value) in _PLAIN or type(value) is tuple or type(value) is BoxShape:
            constants[name] = normalised(name, value)
    return constants


def _by_specifier(owners: Mapping[str, Specifier]) -> dict[Specifier, frozenset[str]]:
    result: dict[Specifier, frozenset[str]] = {}
    for name, specifier in owners.items():
        result[specifier] = result.get(specifier, frozenset()) | {name}
    return result


def _topological(
    owns: Mapping[Specifier, frozenset[str]],
    modifies: Mapping[Specifier, frozenset[str]],
    claims: Mapping[str, Specifier],
    modifiers: Mapping[str, Specifier],
) -> tuple[Specifier, ...]:
    """Order providers before the specifiers that read them, by depth-first search in program order."""
    order: list[Specifier] = []
    ordered_specifiers: set[Specifier] = set()
    active: list[Specifier] = []

    def visit(specifier: Specifier) -> None:
        if specifier in ordered_specifiers:
            return
        if specifier in active:
            raise _circle(active[active.index(specifier) :])
        active.append(specifier)
        for name in sorted(specifier.dependencies):
            provider = modifiers.get(name) or claims.get(name)
            if provider is None:
                raise SpecifierError(
                    f"{specifier} needs property {name!r}, which nothing provides",
                    span=specifier.span,
                    help=f"give the class a default for it, or the object a value: `with {name} ...`",
                )
            visit(provider)
        for name in sorted(modifies.get(specifier, ())):
            visit(claims[name])
        active.pop()
        ordered_specifiers.add(specifier)
        order.append(specifier)

    for specifier in (*owns, *modifies):
        visit(specifier)
    return tuple(order)


def _circle(specifiers: Sequence[Specifier]) -> SpecifierError:
    circle = [*specifiers, specifiers[0]]
    return SpecifierError(
        "these specifiers depend on each other: " + " -> ".join(str(item) for item in circle),
        span=next((item.span for item in circle if item.span is not None), None),
        help="give one of the properties a value that does not depend on the others",
    )


def _check_value(name: str, value: object, *, mode_2d: bool) -> None:
    """Raise an error for a property of an object that no object can have."""
    if name in ("width", "length", "height") and is_number(value) and not 0 < value < math.inf:
        raise ScenicValueError(
            f"property {name!r} must be {'finite' if value > 0 else 'greater than 0'}, not {value:g}",
            span=here(),
            help="sizes are in metres",
        )
    if mode_2d and name == "shape" and not isinstance(value, BoxShape):
        raise InvalidScenarioError(
            f"in 2D mode every object is a box, not {value!r}",
            span=here(),
            help="leave out the shape, or compile without 2D mode",
        )


def check_assigned(instance: Any, name: str, *, mode_2d: bool) -> None:
    """Check and convert what the program has assigned to a property, as `with` does; what follows from it follows anew.

    Raises `InvalidScenarioError` for a property that itself follows from others.
    """
    entry = instance.scenic_properties.get(name)
    values = instance.__dict__
    is_derived = isinstance(getattr_static(type(instance), name, None), Yielding)
    if name not in values or (entry is None and not is_derived):
        return
    if entry is None or entry.final:
        of = (
            ": width, length and height"
            if is_derived
            else ": yaw, pitch and roll"
            if name in _DIRECTIONS
            else ""
        )
        raise InvalidScenarioError(
            f"property {name!r} follows from others and cannot be assigned",
            span=here(),
            help=f"assign what it follows from{of}",
        )
    value = settle(values[name], instance)
    values.pop(MEMO, None)
    value = normalised(name, value)
    if isinstance(instance, Object):
        if mode_2d and name == "position":
            value = normalised(name, (value.x, value.y, 0))
        _check_value(name, value, mode_2d=mode_2d)
    values[name] = value
    finals = Finals.of(instance.scenic_properties)
    for entry in finals.builtin:
        values[entry.name] = entry.default(instance)
    finals.renew_own(instance)


def _quoted(names: frozenset[str]) -> str:
    return ", ".join(repr(name) for name in sorted(names))


__all__ = ["SpecifierResolution", "build", "check_assigned", "class_defaults", "resolve"]
