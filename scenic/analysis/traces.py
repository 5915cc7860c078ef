"""Temporal requirements that contradict each other in every simulation, found by following them over all traces.

The truth of each atom in each state is free, but for atoms that are the same expression over the same values. What monitors have
left to see takes finitely many forms, so that a search state by state, shortest traces first, ends: with a trace that meets
all requirements, or with the proof that there is none.
"""

from collections import deque
from collections.abc import Hashable, Sequence
from copy import copy
from itertools import product
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType
from typing import Final

from scenic.runtime.description.declarations import Closure, Required
from scenic.runtime.temporal.formulas import is_temporal
from scenic.runtime.temporal.monitors import FormulaMonitor, Verdict

__all__ = ["contradictions", "shortest_trace"]

MOST_ATOMS: Final = 8
"""Different atoms in a group of requirements, at most."""

MOST_STATES: Final = 20_000
"""Largest number of states added to monitors in one search, after which the search gives up."""


_CALLED: Final = (FunctionType, BuiltinFunctionType, MethodType, type)


class _UndecidedError(Exception):
    """The search took too long."""


def contradictions(requirements: Sequence[Required]) -> list[tuple[tuple[Required, ...], int]]:
    """Smallest sets of requirements that no simulation meets, in program order.

    Each comes with the number of states of a shortest trace that meets all of them but the last.
    """
    cores = []
    for group in _groups(requirements):
        if not any(is_temporal(item.formula) for item in group):
            continue
        try:
            if shortest_trace(group) is not None:
                continue
            core = group
            for item in group:
                rest = [member for member in core if member is not item]
                if rest and shortest_trace(rest) is None:
                    core = rest
            others = core[:-1]
            cores.append((tuple(core), (shortest_trace(others) or 0) if others else 0))
        except _UndecidedError:
            continue
    return cores


def shortest_trace(requirements: Sequence[Required]) -> int | None:
    """The number of states of a shortest trace that meets all requirements; ``None`` if there is none."""
    number: dict[Hashable, int] = {}
    values_of_atoms: dict[int, bool] = {}
    atoms = [[number.setdefault(_key(atom), len(number)) for atom in item.atoms] for item in requirements]
    for item, mine in zip(requirements, atoms, strict=True):
        values_of_atoms |= {
            place: bool(atom()) for place, atom in zip(mine, item.atoms, strict=True) if _is_fixed(atom)
        }
    if len(number) - len(values_of_atoms) > MOST_ATOMS:
        raise _UndecidedError
    choices = [
        (values_of_atoms[place],) if place in values_of_atoms else (False, True)
        for place in range(len(number))
    ]
    start = tuple(FormulaMonitor(item.formula) for item in requirements)
    waiting: deque[tuple[int, tuple[FormulaMonitor, ...]]] = deque([(0, start)])
    states_done: set[Hashable] = set()
    state_count = 0
    while waiting:
        length, monitors = waiting.popleft()
        for truths in product(*choices):
            state_count += 1
            if state_count > MOST_STATES:
                raise _UndecidedError
            after = tuple(copy(monitor) for monitor in monitors)
            verdicts = [
                monitor.add(lambda atom, mine=mine, truths=truths: truths[mine[atom]])  # type: ignore[misc]
                for monitor, mine in zip(after, atoms, strict=True)
            ]
            if all(verdicts):
                return length + 1
            left = tuple(monitor.left for monitor in after)
            if Verdict.FALSE in verdicts or left in states_done:
                continue
            states_done.add(left)
            waiting.append((length + 1, after))
    return None


def _groups(requirements: Sequence[Required]) -> list[list[Required]]:
    """The requirements in groups that share no atom."""
    groups: list[tuple[set[Hashable], list[Required]]] = []
    for item in requirements:
        keys = {_key(atom) for atom in item.atoms}
        groups_to_join = [group for group in groups if group[0] & keys]
        members = [member for _, group in groups_to_join for member in group]
        keys = keys.union(*(atoms for atoms, _ in groups_to_join))
        groups = [group for group in groups if group not in groups_to_join]
        groups.append((keys, [*members, item]))
    order = {id(item): place for place, item in enumerate(requirements)}
    return [sorted(members, key=lambda item: order[id(item)]) for _, members in groups]


def _is_fixed(atom: Closure) -> bool:
    """Return whether an atom is made of constants alone."""
    function = atom.function
    return isinstance(function, FunctionType) and not atom.captured and not function.__code__.co_names


def _key(atom: Closure) -> Hashable:
    """Return a key that is equal for atoms of the same expression over the same values; each atom that calls a function of the program has its own."""
    function = atom.function
    if not isinstance(function, FunctionType) or any(isinstance(item, _CALLED) for item in atom.captured):
        return id(atom)
    return (_code_key(function.__code__), tuple(map(_value_key, atom.captured)))


def _code_key(code: CodeType) -> Hashable:
    """Return a key that is equal for code of equal effect, wherever the code is defined."""
    constants = tuple(
        _code_key(item) if isinstance(item, CodeType) else _value_key(item) for item in code.co_consts
    )
    return code.co_code, code.co_names, code.co_varnames, constants


def _value_key(value: object) -> Hashable:
    return (type(value), value) if isinstance(value, int | float | str) else id(value)
