"""What infinite continuations decide: the certain verdicts of RV-LTL by their definition.

After a finite trace a formula is certain if all infinite traces that begin with it agree on it (A. Bauer, M. Leucker,
C. Schallhart, *Comparing LTL semantics for runtime verification*, 2010, where LTL3 and RV-LTL are defined). Whether
there is a continuation that fulfils a formula is found with the classical tableau: a state of it says which atoms hold and
which formulas hold from the next state on; a run through it is a model if nothing that is promised stays away for ever.
Nothing of this is shared with `fuzz.traces`.
"""

from collections.abc import Sequence
from itertools import product

from fuzz.traces import Formula, State

_PROMISING = {"until", "eventually", "always"}
_TIMED = _PROMISING | {"next"}

Truth = dict[Formula, bool]
"""A state of the tableau: atoms, and of a temporal formula what has to hold from the next state on."""


def can_be_met(formula: Formula, trace: Sequence[State]) -> bool:
    """Whether some infinite trace that begins with the states of ``trace`` fulfils ``formula``."""
    return _Tableau(formula).can_go_on(trace)


class _Tableau:
    def __init__(self, formula: Formula) -> None:
        self.formula = formula
        parts = list(dict.fromkeys(_parts(formula)))
        self.atoms = [part for part in parts if isinstance(part, str)]
        self.timed = [part for part in parts if isinstance(part, tuple) and part[0] in _TIMED]
        self.states: list[Truth] = [
            dict(zip([*self.atoms, *self.timed], values, strict=True))
            for values in product((False, True), repeat=len(self.atoms) + len(self.timed))
        ]
        self.before: dict[tuple[bool, ...], set[int]] = {}
        """The states by what they say of the next one."""
        for index, state in enumerate(self.states):
            self.before.setdefault(tuple(state[part] for part in self.timed), set()).add(index)
        self.entry = [tuple(self.true(state, _later(part)) for part in self.timed) for state in self.states]
        """What a state before each of them says of it."""

    def true(self, state: Truth, formula: Formula) -> bool:
        """Whether a formula holds in a state, as far as it is told what holds later."""
        match formula:
            case str():
                return state[formula]
            case ("not", one):
                return not self.true(state, one)
            case ("and", *several):
                return all(self.true(state, each) for each in several)
            case ("or", *several):
                return any(self.true(state, each) for each in several)
            case ("implies", one, other):
                return not self.true(state, one) or self.true(state, other)
            case ("next", _):
                return state[formula]
            case ("always", one):
                return self.true(state, one) and state[formula]
            case ("eventually", one):
                return self.true(state, one) or state[formula]
            case ("until", one, other):
                return self.true(state, other) or (self.true(state, one) and state[formula])
        raise ValueError(formula)

    def kept(self, state: Truth, formula: Formula) -> bool:
        """Whether what a formula promises is not open in a state: this has to be so again and again."""
        match formula:
            case ("until", _, goal) | ("eventually", goal):
                return not self.true(state, formula) or self.true(state, goal)
            case ("always", one):
                return self.true(state, formula) or not self.true(state, one)
        raise ValueError(formula)

    def predecessors(self, states: set[int]) -> set[int]:
        return set().union(
            *(self.before.get(entry, set()) for entry in {self.entry[each] for each in states})
        )

    def endless(self) -> set[int]:
        """The states from which a run goes on for ever and keeps all promises again and again."""
        promises = [
            {index for index, state in enumerate(self.states) if self.kept(state, part)}
            for part in self.timed
            if part[0] in _PROMISING
        ]
        found = set(range(len(self.states)))
        while True:
            smaller = found & self.predecessors(found)
            for promise in promises:
                reached = smaller & promise
                while not (more := smaller & self.predecessors(reached)) <= reached:
                    reached |= more
                smaller &= self.predecessors(reached)
            if smaller == found:
                return found
            found = smaller

    def can_go_on(self, trace: Sequence[State]) -> bool:
        here = {index for index, state in enumerate(self.states) if self.true(state, self.formula)}
        for position, letters in enumerate(trace):
            if position:
                said = {tuple(self.states[each][part] for part in self.timed) for each in here}
                here = {index for index, entry in enumerate(self.entry) if entry in said}
            here = {
                index for index in here if all(self.states[index][a] == (a in letters) for a in self.atoms)
            }
        return bool(here & self.endless())


def _later(part: Formula) -> Formula:
    """What a state says to hold from the next state on if it says that ``part`` does."""
    return part[1] if isinstance(part, tuple) and part[0] == "next" else part


def _parts(formula: Formula) -> list[Formula]:
    """A formula and all formulas in it."""
    if isinstance(formula, tuple):
        return [formula, *(part for each in formula[1:] for part in _parts(each))]
    return [formula]
