"""The statements that take time, as generators to which code delegates (sections 12.2 and 12.4)."""

import math
from collections.abc import Callable, Generator, Iterator, Sequence
from types import GeneratorType
from typing import Any, Final, cast

from scenic.language.errors import (
    InvariantViolation,
    RejectSimulationException,
    ScenicTypeError,
    ScenicValueError,
)
from scenic.runtime.description.definitions import Behavior, Invocable, ModularScenario, Monitor
from scenic.runtime.dynamics.activations import Activation, Termination, Yielded
from scenic.runtime.ground.context import here
from scenic.runtime.values.values import describe, is_number

__all__ = [
    "ABORT",
    "BREAK",
    "CONTINUE",
    "BlockEnding",
    "choose",
    "do",
    "interruptible",
    "limit_in_steps",
    "shuffle",
    "wait",
]

Running = Any  # Activation | ScenarioActivation: what resumes, checks guards and stops
Steps = Generator[Yielded, None, Any]


class BlockEnding:
    """The way in which a block of ``try-interrupt`` ended, other than at its end; ``value`` is that of ``return``."""

    __slots__ = ("value", "way")

    def __init__(self, way: str, value: object = None) -> None:
        self.way = way
        self.value = value


ABORT: Final = BlockEnding("abort")
BREAK: Final = BlockEnding("break")
CONTINUE: Final = BlockEnding("continue")


def limit_in_steps(value: object, unit: str, timestep: float, what: str) -> float:
    """A duration in steps, not rounded."""
    if not is_number(value) or isinstance(value, bool):
        raise ScenicTypeError(f"{what}: expected a number of {unit}, not {describe(value)}", span=here())
    return value / timestep if unit == "seconds" else value


def _stop_test(owner: Running, limit: Any, unit: str | None) -> Callable[[], bool] | None:
    """Return the test, run before each resumption, of whether a limit (`for`, `until`) has been reached;
    ``None`` if there is no limit.
    """
    if unit is None:
        return None
    run = owner.run
    if unit == "until":

        def holds() -> bool:
            with run.guard():
                return bool(limit())

        return holds
    steps = limit_in_steps(limit, unit, run.simulation.timestep, "`for`")
    start = run.simulation.currentTime
    return lambda: run.simulation.currentTime - start >= steps


def begin(owner: Running, target: object) -> Running:
    """Make something ready to be started from within something else."""
    in_compose = owner.composes
    if isinstance(target, type) and issubclass(target, Invocable):
        hint = f"write `do {target.__name__}()`"
    elif isinstance(target, tuple | list):
        hint = "write the targets one after the other, `do A(), B()`"
    else:
        hint = None
    if in_compose and isinstance(target, ModularScenario):
        return owner.run.activation(target, owner)
    kind = Monitor if owner.instance._kind == "monitor" else Behavior
    if not in_compose and isinstance(target, Behavior | kind):
        return Activation(owner.run, target, owner.agent, owner.scenario)
    expectation = "a scenario" if in_compose else "a behavior"
    raise ScenicTypeError(f"`do`: expected {expectation}, not {describe(target)}", span=here(), help=hint)


def do(owner: Running, targets: Sequence[object], limit: object = None, unit: str | None = None) -> Steps:
    """Execute ``do``, with ``for`` or ``until``."""
    stop = _stop_test(owner, limit, unit)
    activations: list[Running] = []
    try:
        # What is over at once is not even set up; a condition may read what only the set-up will make.
        over = owner.run.holds(limit) if unit == "until" else stop is not None and stop()
        if not over:
            for target in targets:
                sub = begin(owner, target)
                activations.append(sub)
                sub.start()
        waiting = activations
        while waiting:
            if len(waiting) == 1:
                output = waiting[0].resume()
                if output is None:
                    break
            else:
                outputs = [(sub, sub.resume()) for sub in waiting]
                waiting = [sub for sub, actions in outputs if actions is not None]
                if not waiting:
                    break
                output = _joined([actions for _, actions in outputs if actions is not None])
            owner.direct = False
            yield output
            if stop is not None and stop():
                break
    except Exception:
        # What went wrong is told, not what did not come true for it.
        for sub in activations:
            try:
                sub.stop()
            except RejectSimulationException as unmet:
                owner.run.unmet = owner.run.unmet or unmet
        raise
    finally:
        for sub in activations:
            sub.stop()
    owner.check_invariants()


def _joined(outputs: Sequence[Yielded]) -> Yielded:
    """The actions of a step of all that runs side by side, in order; the first request to terminate among them counts."""
    actions: tuple[Any, ...] = ()
    for output in outputs:
        if isinstance(output, Termination):
            return output
        actions += output
    return actions


def wait(owner: Running, limit: object, unit: str) -> Steps:
    """Execute ``wait for`` and ``wait until``."""
    stop = _stop_test(owner, limit, unit)
    assert stop is not None
    while not stop():
        owner.direct = False
        yield ()
    owner.check_invariants()


def choose(owner: Running, targets: Sequence[object]) -> Steps:
    """Execute ``do choose``."""
    options = _weighted(targets, "choose")
    index = _drawn(owner, options, "choose")
    yield from do(owner, [options[index][0]])


def shuffle(owner: Running, targets: Sequence[object]) -> Steps:
    """Execute ``do shuffle``."""
    options = _weighted(targets, "shuffle")
    while options:
        target, _ = options.pop(_drawn(owner, options, "shuffle"))
        yield from do(owner, [target])


def _weighted(targets: Sequence[object], what: str) -> list[tuple[Any, float]]:
    """Return the targets with their weights."""
    if len(targets) == 1 and isinstance(targets[0], dict):
        options = list(targets[0].items())
        for _, weight in options:
            if not is_number(weight):
                raise ScenicTypeError(
                    f"`do {what}`: a weight is a number, not {describe(weight)}", span=here()
                )
            if not 0 <= weight < math.inf:
                raise ScenicValueError(
                    f"`do {what}`: a weight is a number from 0 on, not {weight}", span=here()
                )
        return options
    return [(target, 1.0) for target in targets]


def _drawn(owner: Running, options: Sequence[tuple[Any, float]], what: str) -> int:
    """The number of one of those that may start now."""
    eligible = [
        index
        for index, (target, weight) in enumerate(options)
        if weight > 0 and begin(owner, target).may_start()
    ]
    if not eligible:
        raise RejectSimulationException(f"nothing that `do {what}` names may start")
    mark = owner.run.draws.random() * sum(options[index][1] for index in eligible)
    for index in eligible:
        mark -= options[index][1]
        if mark < 0:
            return index
    return eligible[-1]


def interruptible(
    owner: Running, body: Callable[[], Any], clauses: Sequence[tuple[Callable[[], Any], Callable[[], Any]]]
) -> Generator[Yielded, None, BlockEnding | None]:
    """Execute ``try-interrupt``: the body, and conditions with their handlers in program order; returns how it ended."""
    run = owner.run
    blocks: list[Any] = [None] * len(clauses)  # The handlers that have begun.
    main: Any = None
    conditions = [condition for condition, _ in clauses]
    order = range(len(clauses) - 1, -1, -1)
    waiting: set[int] = set()
    """The blocks whose last yield was a statement of their own; the body is the last of all, -1."""
    after_handler = False
    try:
        while True:
            clause = -1
            for index in order:
                if blocks[index] is not None or run.holds(conditions[index]):
                    clause = index
                    break
            if clause < 0:
                block = main = body() if main is None else main
            elif blocks[clause] is None:
                block = blocks[clause] = clauses[clause][1]()
            else:
                block = blocks[clause]
            if isinstance(block, GeneratorType):
                violation: InvariantViolation | None = None
                if after_handler and clause in waiting:
                    # A handler may have broken in this step what the block that it preempted relies on.
                    try:
                        owner.check_invariants()
                    except InvariantViolation as error:
                        violation = error
                try:
                    output = (
                        next(cast("Iterator[Yielded]", block))
                        if violation is None
                        else block.throw(violation)
                    )
                except StopIteration as end:
                    outcome = end.value
                else:
                    (waiting.add if owner.direct else waiting.discard)(clause)
                    after_handler = False
                    yield output
                    continue
            else:
                outcome = block  # A block in which nothing takes time has run to its end.
            if outcome is not None or clause < 0:
                return outcome  # type: ignore[no-any-return] # blocks return outcomes
            blocks[clause] = None
            waiting.discard(clause)
            after_handler = True
    finally:
        for block in (*blocks, main):
            if isinstance(block, GeneratorType):
                block.close()
