"""Choice of names: the names that a program binds, and the names that may be read at each place.

Every name of a sentence has a *role*, which follows from the rule it stands in. `Names` keeps the scopes that are open and
chooses: mostly something that fits and is in scope, and now and then anything.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Final

from fuzz.derivations import Option
from fuzz.places import Step
from scenic.language.names import NAMES, RESERVED, TRACKED, NameKind
from scenic.language.properties import CLASSES

__all__ = ["SCALE", "SCOPES", "SIGNATURES", "Names", "Role", "role_given", "roles_of"]

SCALE: Final = 1 << 12
"""A name is chosen by a number below this one."""


class Role(Enum):
    """The role of a name in a sentence."""

    ANY = auto()
    """Nothing depends on it."""
    READ = auto()
    CLASS = auto()
    """The class after ``new``."""
    RUNNABLE = auto()
    """The operand of ``do``: a behavior, or a scenario."""
    OBJECT = auto()
    MODULE = auto()
    """An imported module."""
    IMPORTED = auto()
    """The same, which binds its first part."""
    ATTRIBUTE = auto()
    PROPERTY = auto()
    KEYWORD = auto()
    PARAMETER = auto()
    CAPTURE = auto()
    GLOBAL = auto()
    NONLOCAL = auto()
    DELETED = auto()
    TRACKED = auto()
    BIND_VALUE = auto()
    BIND_FUNCTION = auto()
    BIND_CLASS = auto()
    BIND_BEHAVIOR = auto()
    BIND_MONITOR = auto()
    BIND_SCENARIO = auto()


_ROLES: Final[Mapping[str, tuple[Role, ...]]] = {
    "type_alias": (Role.BIND_VALUE,),
    "imported_name": (Role.ANY, Role.BIND_VALUE),
    "dotted_alias": (Role.BIND_VALUE,),
    "dotted_name": (Role.MODULE,),
    "except_block": (Role.BIND_VALUE,),
    "except_star_block": (Role.BIND_VALUE,),
    "function_signature": (Role.BIND_FUNCTION,),
    "annotated_name": (Role.PARAMETER,),
    "starred_parameter": (Role.PARAMETER,),
    "bare_name": (Role.PARAMETER,),
    "type_parameter": (Role.PARAMETER,),
    "class_definition": (Role.BIND_CLASS,),
    "property_definition": (Role.PROPERTY,),
    "pattern": (Role.CAPTURE,),
    "closed_pattern": (Role.CAPTURE,),
    "maybe_star_pattern": (Role.CAPTURE,),
    "mapping_item": (Role.CAPTURE,),
    "class_pattern_argument": (Role.KEYWORD,),
    "behavior_definition": (Role.BIND_BEHAVIOR,),
    "monitor_definition": (Role.BIND_MONITOR,),
    "scenario_definition": (Role.BIND_SCENARIO,),
    "parameter_setting": (Role.KEYWORD,),
    "specifier": (Role.PROPERTY,),
    "named_expression": (Role.BIND_VALUE,),
    "subscript": (Role.BIND_VALUE,),
    "atom": (Role.READ,),
    "primary": (Role.ATTRIBUTE,),
    "dotted_value": (Role.ATTRIBUTE,),
    "class_name": (Role.ATTRIBUTE,),
    "argument": (Role.KEYWORD,),
    "name_load": (Role.READ,),
    # Rules of the narrowing.
    "tracked_assignment": (Role.TRACKED,),
    "tracked_block_assignment": (Role.TRACKED,),
    "visible_assignment": (Role.ATTRIBUTE,),
    "visible_place": (Role.ATTRIBUTE,),
    "place": (Role.BIND_VALUE,),
    "field": (Role.ATTRIBUTE,),
    "single_place": (Role.BIND_VALUE,),
    "other_place": (Role.BIND_VALUE,),
    "annotated_name_statement": (Role.BIND_VALUE,),
    "annotated_place": (Role.BIND_VALUE,),
    "deleted": (Role.DELETED,),
    "done": (Role.RUNNABLE,),
}
"""The roles of the names in a rule's own items. They belong to the last ones of an alternative that has fewer."""

_OF_REFERENCES: Final[Mapping[tuple[str, str], Role]] = {
    ("new_expression", "name_load"): Role.CLASS,
    ("class_name", "name_load"): Role.CLASS,
    ("soft_statement", "name_load"): Role.OBJECT,
    ("dotted_alias", "dotted_name"): Role.IMPORTED,
}
"""Roles that a rule gives to the first name of one that it refers to."""

SIGNATURES: Final = frozenset(
    {
        "function_definition",
        "async_function",
        "lambda_expression",
        "behavior_definition",
        "monitor_definition",
        "scenario_definition",
    }
)
"""Rules with parameters, which are bound within."""


def roles_of(option: Option, nodes: frozenset[str], count: int) -> Sequence[Role]:
    """The roles of the ``count`` names among an option's items."""
    if "Global" in nodes:
        return [Role.GLOBAL] * count
    if "Nonlocal" in nodes:
        return [Role.NONLOCAL] * count
    path = {each.rule for each in option.counts_as}
    common_role = next(
        (role for (rule, used_rule), role in _OF_REFERENCES.items() if {rule, used_rule} <= path), None
    )
    if common_role is not None:
        return [common_role] * count
    roles = _ROLES.get(option.rule, ())[-count:] if count else ()
    return [*[Role.ANY] * (count - len(roles)), *roles]


def role_given(option: Option, rule: str) -> Role | None:
    """Return the role that an option gives to the first name of a rule that it refers to."""
    if option.rule == "dotted_alias" and len(option.items) > 1:
        return Role.MODULE
    return _OF_REFERENCES.get((option.rule, rule))


class Kind(Enum):
    """The kind of thing that a name is bound to, as far as the text shows."""

    VALUE = auto()
    CLASS = auto()
    RUNNABLE = auto()


_KINDS: Final[Mapping[Role, Kind]] = {
    Role.BIND_CLASS: Kind.CLASS,
    Role.BIND_BEHAVIOR: Kind.RUNNABLE,
    Role.BIND_SCENARIO: Kind.RUNNABLE,
}
_FRESH: Final[Mapping[Role, tuple[str, ...]]] = {
    Role.BIND_VALUE: ("x", "y", "a", "b", "car", "i", "n", "_", "é"),
    Role.BIND_FUNCTION: ("f", "g", "h"),
    Role.BIND_CLASS: ("C", "D", "Car"),
    Role.BIND_BEHAVIOR: ("B", "Drive", "Stop"),
    Role.BIND_MONITOR: ("M", "Watch"),
    Role.BIND_SCENARIO: ("S", "Main", "Sub"),
    Role.PARAMETER: ("p", "q", "k", "v", "self", "z1", "z2", "z3", "z4", "z5"),
    Role.CAPTURE: ("c", "d", "e", "c1", "c2", "c3", "c4", "c5", "c6"),
    Role.MODULE: ("m", "os", "lib", "math"),
    Role.IMPORTED: ("m", "os", "lib", "math"),
    Role.ATTRIBUTE: ("position", "x", "width", "heading", "real", "a", "object"),
    Role.PROPERTY: ("width", "height", "behavior", "color", "viewAngle", "p1", "p2", "p3", "speed", "mass"),
    Role.KEYWORD: ("k", "low", "high", "x", "key", "k1", "k2", "k3", "k4", "k5", "k6", "k7"),
    Role.ANY: ("x", "y", "name", "é"),
    Role.TRACKED: ("ego", "ego", "ego", "ego", "workspace"),
    Role.GLOBAL: tuple(f"g{number}" for number in range(1, 9)),
}
"""Names for what is not read from a scope, the plainest first."""
_ONCE: Final = frozenset({Role.PARAMETER, Role.CAPTURE, Role.PROPERTY, Role.KEYWORD, Role.GLOBAL})
"""Roles in which a name may often occur only once; these roles take the names in turn."""
_OWN_SHARE: Final = 0.75
"""Share of reads that read a name that the program binds, if there is one."""
_SOFT_SHARE: Final = 0.15
"""Share of bindings whose name is a soft keyword or something odd."""
_ODD: Final = ("_", "__x", "é", "ﬁ", "𝐱", "print", "int", "ego", "self", "workspace", "undefined")
"""Among them two that are normalised to other characters."""
_PROVIDED: Final = (
    "Range", "Object", "abs", "everywhere", "Uniform", "workspace", "globalParameters", "len", "Vector", "print",
    "Normal", "max", "BoxRegion", "sin", "CircularRegion", "range", "Discrete", "DiscreteRange",
)  # fmt: skip
_CLASSES: Final = tuple(name for name in CLASSES if NAMES[name].kind is NameKind.CLASS)[::-1]
_WITH_BLOCKS: Final = frozenset({"def", "async def", "class", "behavior", "monitor", "scenario"})
_FUNCTIONS: Final = frozenset({"def", "async def", "lambda", "behavior", "monitor", "scenario"})
SCOPES: Final = _WITH_BLOCKS | {"lambda", "property", "comprehension"}
"""Steps that open a scope."""


@dataclass(slots=True)
class _Scope:
    """The names bound in an open scope; ``touched`` are all names that were used in it."""

    kind: Step
    names: dict[str, Kind] = field(default_factory=dict)
    touched: set[str] = field(default_factory=set)


class Names:
    """The open scopes of a sentence that is being made.

    If ``wild``, names are often bound and read where that makes no sense, reserved ones too.
    """

    def __init__(self, soft_keywords: Sequence[str], *, wild: bool) -> None:
        self._wild = wild
        self._odd = (*soft_keywords, *_ODD)
        self._bindable = tuple(name for name in self._odd if name not in RESERVED and name != "undefined")
        self._scopes = [_Scope("module")]
        self._pending: list[tuple[_Scope, str, Kind]] = []
        """Bound by the statement that is being made, so not to be read in it."""
        self._signatures: list[dict[str, Kind]] = []
        self._turns = 0

    # Scopes.

    def open_signature(self) -> None:
        """Parameters from here on belong to a definition of their own."""
        self._signatures.append({})

    def close_signature(self) -> None:
        self._signatures.pop()

    def open(self, step: Step) -> None:
        """Open a scope, and bind the parameters before it in it."""
        scope = _Scope(step)
        if step in _FUNCTIONS and self._signatures:
            scope.names.update(self._signatures[-1])
            scope.touched.update(scope.names)
        if step == "behavior":
            scope.names["self"] = Kind.VALUE
        if step in _WITH_BLOCKS:
            self._flush()
        self._scopes.append(scope)

    def close(self) -> None:
        self._scopes.pop()

    def end_line(self) -> None:
        """End a line: the names that it binds can be read from now on."""
        self._flush()

    def _flush(self) -> None:
        for scope, name, kind in self._pending:
            scope.names[name] = kind
        self._pending.clear()

    # Choosing.

    def has_outer(self) -> bool:
        """Return whether there is a name that ``nonlocal`` can take."""
        return bool(self._of_outer())

    def has_ego(self) -> bool:
        """Return whether the ego has been set before."""
        return any("ego" in scope.names for scope in self._scopes)

    def choose(self, role: Role, number: int, fits: Callable[[str], bool]) -> str:
        """A name for ``role`` for which ``fits`` holds, by a number below `SCALE`."""
        share = number / SCALE
        if share >= (0.8 if self._wild else 0.995):
            return self._pick(self._odd, number, fits)
        candidates = self._candidates(role)
        if candidates is None:
            name = self._fresh(role, share, number, fits)
        else:
            own_names, other_names = candidates
            if own_names and (share < _OWN_SHARE or not other_names):
                name = self._pick(
                    own_names, int(share / (_OWN_SHARE if other_names else 1) * len(own_names)), fits
                )
            else:
                name = self._pick(other_names, number, fits)
        self._use(role, name)
        return name

    def _pick(self, names: Sequence[str], index: int, fits: Callable[[str], bool]) -> str:
        name = names[index % len(names)]
        if fits(name):
            return name
        return next((each for each in (*names, *_PROVIDED) if fits(each)), "x")

    def _fresh(self, role: Role, share: float, number: int, fits: Callable[[str], bool]) -> str:
        names = _FRESH[role]
        names_in_use: frozenset[str] | set[str] | dict[str, Kind] = frozenset()
        if role is Role.PARAMETER and self._signatures:
            names_in_use = self._signatures[-1]
        elif role is Role.GLOBAL or (role is Role.PROPERTY and self._scopes[-1].kind == "class"):
            names_in_use = self._scopes[-1].touched
        if role in _ONCE:
            self._turns += 1
            if role is not Role.PARAMETER and not self._wild:
                names = (*names[self._turns % len(names) :], *names[: self._turns % len(names)])
        elif share > 1 - _SOFT_SHARE and role is not Role.TRACKED:
            return self._pick(self._bindable, number, fits)
        return self._pick(
            names, int(share * len(names)), lambda name: name not in names_in_use and fits(name)
        )

    def _use(self, role: Role, name: str) -> None:
        scope = self._scopes[-1]
        scope.touched.add(name)
        if role is Role.PARAMETER and self._signatures:
            self._signatures[-1][name] = Kind.VALUE
        elif role is Role.TRACKED:
            self._pending.append((scope, name, Kind.VALUE))
        elif role is Role.DELETED:
            scope.names.pop(name, None)
        elif role in (Role.CAPTURE, Role.IMPORTED) or role.name.startswith("BIND_"):
            self._pending.append((scope, name, _KINDS.get(role, Kind.VALUE)))

    # What is in reach.

    def _candidates(self, role: Role) -> tuple[Sequence[str], Sequence[str]] | None:
        """Return the names that fit a role whose names are already in scope: names of the program, and all others.

        ``None`` for roles of other kinds.
        """
        match role:
            case Role.READ | Role.OBJECT:
                return self._reach(None), _PROVIDED
            case Role.CLASS:
                return self._reach(Kind.CLASS), _CLASSES
            case Role.RUNNABLE:
                return self._reach(Kind.RUNNABLE) or self._reach(None), _PROVIDED
            case Role.NONLOCAL:
                return self._of_outer() or _FRESH[Role.BIND_VALUE], ()
            case Role.DELETED:
                own_names = [name for name in self._scopes[-1].names if name not in RESERVED]
                return own_names or _FRESH[Role.BIND_VALUE], ()
            case _:
                return None

    def _reach(self, kind: Kind | None) -> list[str]:
        """The names that can be read, those of inner scopes first."""
        kind_of_name: dict[str, Kind] = {}
        last = len(self._scopes) - 1
        for index in range(last, -1, -1):
            scope = self._scopes[index]
            # The names of a class are out of reach of what is in it.
            if index == last or scope.kind != "class":
                for name, bound_to in reversed(scope.names.items()):
                    kind_of_name.setdefault(name, bound_to)
        if kind is None:
            return list(kind_of_name)
        return [name for name, bound_to in kind_of_name.items() if bound_to is kind]

    def _of_outer(self) -> list[str]:
        inner_scope = self._scopes[-1]
        if inner_scope.kind not in _FUNCTIONS or inner_scope.kind == "lambda":
            return []
        return [
            name
            for scope in self._scopes[1:-1]
            if scope.kind in ("def", "async def")
            for name in scope.names
            if name not in inner_scope.touched and name not in TRACKED
        ]
