"""Verdicts of temporal formulas on the states seen so far (section 12.6 of the specification).

A `FormulaMonitor` holds what has yet to come true, not the states: what it costs to add a state is bounded by the formula. What is
left to hold is kept as a disjunction of conjunctions of *obligations*: subformulas that the next state has to meet.
Since clauses absorb each other, what is left is one of finitely many.

The verdicts are those of RV-LTL (Bauer, Leucker and Schallhart, "Comparing LTL semantics for runtime verification", 2010).
That a formula which its operands do not decide is valid, as ``always (a or not a)`` is, goes unnoticed.
"""

from collections.abc import Callable, Hashable, Sequence
from enum import IntEnum
from functools import partial
from typing import Final, TypeAlias

from scenic.runtime.temporal.formulas import Formula
from scenic.runtime.temporal.normal_form import Connective, Literal, Next, Normal, Obligation, Until, normal

__all__ = ["FormulaMonitor", "Verdict"]


class Verdict(IntEnum):
    """The verdict on a formula after a finite trace; true if it holds as far as the trace goes."""

    FALSE = 1
    PRESUMABLY_FALSE = 2
    PRESUMABLY_TRUE = 3
    TRUE = 4

    def __bool__(self) -> bool:
        return self.value > 2

    @property
    def is_certain(self) -> bool:
        """Return whether no further state can change it."""
        return self in (Verdict.FALSE, Verdict.TRUE)


_Clauses: TypeAlias = frozenset[frozenset[Obligation]]

_FALSE: Final[_Clauses] = frozenset()
_TRUE: Final[_Clauses] = frozenset([frozenset()])


def _either(left: _Clauses, right: _Clauses) -> _Clauses:
    if not left or right == _TRUE or left == right:
        return right
    if not right or left == _TRUE:
        return left
    return _absorbed(left | right)


def _both(left: _Clauses, right: _Clauses) -> _Clauses:
    if not left or not right:
        return _FALSE
    if left in (_TRUE, right):
        return right
    if right == _TRUE:
        return left
    return _absorbed(frozenset(one | other for one in left for other in right))


def _absorbed(clauses: _Clauses) -> _Clauses:
    """Remove the clauses that another one implies."""
    if len(clauses) == 1:
        return clauses
    kept: list[frozenset[Obligation]] = []
    for clause in sorted(clauses, key=len):
        if not any(other <= clause for other in kept):
            kept.append(clause)
    return frozenset(kept)


class FormulaMonitor:
    """Follows one formula along a trace.

    Args:
        formula: what is to hold from the first state on.

    """

    __slots__ = ("_left", "_start", "_steps", "verdict")

    def __init__(self, formula: Formula) -> None:
        self._start: Normal | None = normal(formula)
        self._left: _Clauses = _FALSE
        self._steps: dict[_Clauses, tuple[_Clauses, _Step]] = {}
        """The known steps by what was left before."""
        self.verdict: Verdict | None = None
        """The verdict on the states so far; ``None`` before the first."""

    @property
    def left(self) -> Hashable:
        """The remaining obligation, with the verdict: monitors of one formula with equal obligations behave the same from now on."""
        return self.verdict, self._left

    def add(self, evaluate: Callable[[int], bool]) -> Verdict:
        """The verdict after one more state, in which ``evaluate`` gives the truth of atoms by their number.

        Only atoms that still matter are evaluated, and none once the verdict is certain. An exception of an atom counts
        only where the others do not decide; then it is raised.
        """
        if self._start is not None:
            left = _progressed(self._start, evaluate)
            self._start = None
        elif self._left == _TRUE or not self._left:
            assert self.verdict is not None
            return self.verdict
        else:
            transition = self._steps.get(self._left)
            if transition is None:
                transition = self._steps[self._left] = self._left, _Step()
            # Of equal sets one, since others may ask for atoms in another order.
            self._left, step = transition
            left = step.taken(evaluate, self._next)
        if left is not self._left or self.verdict is None:
            self._left = left
            self.verdict = _verdict(left)
        return self.verdict

    def _next(self, evaluate: Callable[[int], bool]) -> _Clauses:
        known: dict[Normal, _Clauses | Exception] = {}

        def clause(parts: frozenset[Obligation]) -> _Clauses:
            return _decided(True, [partial(_once, part, evaluate, known) for _, part in parts])

        clauses = [partial(clause, parts) for parts in self._left]
        return clauses[0]() if len(clauses) == 1 else _decided(False, clauses)


def _verdict(left: _Clauses) -> Verdict:
    """Return the verdict while some obligations are left."""
    if not left:
        return Verdict.FALSE
    if left == _TRUE:
        return Verdict.TRUE
    if any(all(weak for weak, _ in clause) for clause in left):
        return Verdict.PRESUMABLY_TRUE
    return Verdict.PRESUMABLY_FALSE


class _Step:
    """A step from certain obligations: the atoms that it asks for one after the other, by their answers, and what is left then."""

    __slots__ = ("_left", "_question", "_then")

    def __init__(self) -> None:
        self._left: _Clauses | None = None
        self._question: int | None = None
        self._then: dict[bool, _Step] = {}

    def taken(
        self,
        evaluate: Callable[[int], bool],
        work_out: Callable[[Callable[[int], bool]], _Clauses],
    ) -> _Clauses:
        """Return what is left after a step; what ``work_out`` gives for answers that have not come up before is kept."""
        step = self
        answers: list[bool] = []
        while step._question is not None:
            try:
                answer = evaluate(step._question)
            except Exception as error:  # noqa: BLE001 - it may not count
                return work_out(_Replayed(answers, evaluate, error))
            answers.append(answer)
            following = step._then.get(answer)
            if following is None:
                break
            step = following
        if step._left is not None:
            return step._left
        replay = _Replayed(answers, evaluate)
        left = work_out(replay)
        if not replay.has_failed:
            self._keep(replay.asked, left)
        return left

    def _keep(self, asked: Sequence[tuple[int, bool]], left: _Clauses) -> None:
        step = self
        for question, answer in asked:
            step._question = question
            step = step._then.setdefault(answer, _Step())
        step._left = left


class _Replayed:
    """Atoms of a state of which the first ones that are asked for have been evaluated; the last of these may have failed."""

    def __init__(
        self, answers: Sequence[bool], evaluate: Callable[[int], bool], error: Exception | None = None
    ) -> None:
        self._answers = iter(answers)
        self._evaluate = evaluate
        self._error = error
        self.has_failed = error is not None
        self.asked: list[tuple[int, bool]] = []

    def __call__(self, index: int) -> bool:
        answer = next(self._answers, None)
        if answer is None:
            error, self._error = self._error, None
            if error is not None:
                raise error
            try:
                answer = self._evaluate(index)
            except Exception:
                self.has_failed = True
                raise
        self.asked.append((index, answer))
        return answer


def _once(
    part: Normal, evaluate: Callable[[int], bool], known: dict[Normal, "_Clauses | Exception"]
) -> _Clauses:
    """Progress an obligation by one state, at most once for all clauses that share it."""
    clauses = known.get(part)
    if clauses is None:
        try:
            clauses = _progressed(part, evaluate)
        except Exception as error:  # noqa: BLE001 - it may not count
            clauses = error
        known[part] = clauses
    if isinstance(clauses, Exception):
        raise clauses
    return clauses


def _progressed(part: Normal, evaluate: Callable[[int], bool]) -> _Clauses:
    """Return the obligations that remain after one more state, in disjunctive clauses."""
    match part:
        case Literal(index, truth):
            return _TRUE if evaluate(index) is truth else _FALSE
        case Connective(conjunction, parts):
            return _decided(conjunction, [partial(_progressed, each, evaluate) for each in parts])
        case Next(weak, later):
            return frozenset([frozenset([(weak, later)])])
        case Until(weak, condition, goal):
            again: _Clauses = frozenset([frozenset([(weak, part)])])

            def go_on() -> _Clauses:
                if condition is None:
                    return again
                return _decided(not weak, [lambda: _progressed(condition, evaluate), lambda: again])

            return _decided(weak, [lambda: _progressed(goal, evaluate), go_on])


def _decided(conjunction: bool, parts: Sequence[Callable[[], _Clauses]]) -> _Clauses:
    """Return the parts joined; raises the first exception of one only if the others do not decide."""
    join, neutral, deciding = (_both, _TRUE, _FALSE) if conjunction else (_either, _FALSE, _TRUE)
    result = neutral
    error: Exception | None = None
    for part in parts:
        try:
            result = join(result, part())
        except Exception as problem:  # noqa: BLE001 - whatever the program raises
            error = problem if error is None else error
        if result == deciding:
            return result
    if error is not None:
        raise error
    return result
