"""The context of a running simulation, apart from what runs there: programs that are only sampled need none of that."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from scenic.runtime.ground.context import Context, Locator, Namer

if TYPE_CHECKING:
    from scenic.runtime.dynamics.run import Run

__all__ = ["RunContext"]


class RunContext(Context):
    """The context of a running simulation: distributions draw at once."""

    def __init__(self, run: "Run", locate: Locator, name: Namer, *, mode_2d: bool) -> None:
        program = run.program.context
        super().__init__(
            locate=locate,
            name=name,
            quote=program.quote,
            generator=run.draws,  # type: ignore[arg-type] # it has `random`
            mode_2d=mode_2d,
        )
        self.filename = program.filename
        self.run = run
        self.guarding = False
        """True if a guard, or the condition of an interrupt or ``until``, is being evaluated."""

    @property
    def present(self) -> Sequence[Any]:
        """The objects of the simulation as they are now."""
        return tuple(self.run.simulation.objects)

    def settled(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return a function of the program over the values of the simulation."""
        own: Callable[..., Any] = self.run.copies.value(function)
        return own
