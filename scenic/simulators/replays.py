"""Replays: what was drawn in a simulation, and how its objects moved, as plain numbers."""

import random
import struct
from collections.abc import Callable, Collection, Sequence
from dataclasses import field
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.language.errors import DivergenceError, SerializationError
from scenic.runtime.dynamics.chosen_draws import Sourcing, kept
from scenic.runtime.dynamics.time_draws import Draw, Draws, Recorded, Seeded, Source
from scenic.runtime.values.values import Orientation, Vector, is_number

__all__ = ["Conditioned", "Replay", "Tape", "fresh_key"]

_MAGIC: Final = b"SCR1"


def fresh_key() -> bytes:
    """A key for the draws of a simulation, from Python's ``random``, so that scripts which seed it repeat."""
    return random.getrandbits(128).to_bytes(16, "little")


@dataclass(slots=True)
class Replay:
    """``key`` decides draws that are not among ``draws`` (address and number, in order); ``states`` are numbers by step."""

    key: bytes
    draws: list[tuple[int, float]] = field(default_factory=list)
    states: list[list[float]] = field(default_factory=list)

    def encoded(self) -> bytes:
        """Return the replay as bytes."""
        parts = [_MAGIC, struct.pack("<B", len(self.key)), self.key, struct.pack("<I", len(self.draws))]
        parts += [struct.pack("<Qd", *draw) for draw in self.draws]
        parts.append(struct.pack("<I", len(self.states)))
        for state in self.states:
            parts.append(struct.pack(f"<I{len(state)}d", len(state), *state))
        return b"".join(parts)

    @staticmethod
    def decoded(data: bytes) -> "Replay":
        """Read a replay from its bytes; raises `SerializationError` for any others."""
        try:
            if data[:4] != _MAGIC:
                raise SerializationError("these bytes are no replay of a simulation")
            position = 5 + data[4]
            key = data[5:position]
            (count,) = struct.unpack_from("<I", data, position)
            position += 4
            end = position + 16 * count
            draws = [
                (int(address), float(number))
                for address, number in struct.iter_unpack("<Qd", data[position:end])
            ]
            (steps,) = struct.unpack_from("<I", data, end)
            position = end + 4
            states: list[list[float]] = []
            for _ in range(steps):
                (width,) = struct.unpack_from("<I", data, position)
                states.append(list(struct.unpack_from(f"<{width}d", data, position + 4)))
                position += 4 + 8 * width
        except (struct.error, IndexError) as error:
            raise SerializationError("the replay of a simulation is damaged") from error
        if position != len(data) or len(draws) != count:
            raise SerializationError("the replay of a simulation is damaged")
        return Replay(key, draws, states)


class Conditioned:
    """Selected draws of an earlier simulation, and new draws otherwise; for the ``source`` of `Simulator.simulate`.

    Args:
        replay: the bytes of the earlier simulation's `getReplay`.
        until: only draws of the steps before this one are kept, so that these steps are the same.
        agents: only draws of the behaviors of these objects are kept, by their places in the simulation; ``None`` among them
            stands for scenarios and monitors.
        keep: only draws for which this function returns true are kept; it is called at each draw.

    Draws that the earlier simulation did not make are always new.

    """

    def __init__(
        self,
        replay: bytes,
        *,
        until: int | None = None,
        agents: Collection[int | None] | None = None,
        keep: Callable[[Draw], bool] | None = None,
    ) -> None:
        self._sourcing = kept(dict(Replay.decoded(replay).draws), until=until, agents=agents, keep=keep)

    def __call__(self, rest: Source) -> Source:
        """Return the source that yields the chosen numbers, and numbers of ``rest`` elsewhere."""
        return self._sourcing(rest)


class Tape:
    """Plays an earlier simulation back, if there is one, and records the present one."""

    def __init__(
        self,
        earlier: Replay | None,
        *,
        key: bytes,
        keep_draws: bool,
        keep_states: bool,
        tolerance: float,
        go_on: bool,
        sourcing: Sourcing | None = None,
    ) -> None:
        self._earlier = earlier
        self._key = key
        self._keep_draws = keep_draws
        # What was recorded with its states is compared with them.
        self._keep_states = keep_states or (earlier is not None and bool(earlier.states))
        self._tolerance = tolerance
        self._go_on = go_on
        self._state: list[float] = []
        self._states: list[list[float]] = []
        self._step = 0
        self.draws: Draws | None = None
        self.replaying = earlier is not None
        """True if the earlier simulation is still followed."""
        seeded_source = Seeded(key)
        self._others: Source = seeded_source if sourcing is None else sourcing(seeded_source)
        self._recorded = (
            None if earlier is None else Recorded(dict(earlier.draws), self._others, self._strayed)
        )
        self.source: Source = _Switch(self)

    def draw(self, place: int, what: Draw) -> float:
        """The number at an address."""
        if self._recorded is None or not self.replaying:
            return self._others.draw(place, what)
        return self._recorded.draw(place, what)

    @property
    def key(self) -> bytes:
        """The key of draws that are not replayed."""
        return self._key

    def _strayed(self) -> None:
        if not self._keep_states:
            return
        self._diverged("a random value is drawn that the recorded simulation did not draw")

    def _diverged(self, what: str) -> None:
        if not self._go_on:
            raise DivergenceError(f"the replay diverged at step {self._step}: {what}")
        self.replaying = False
        # What follows has nothing to do with the earlier simulation, whose key would go on giving its numbers.
        self._others = Seeded(fresh_key())

    # States

    @property
    def keeps_states(self) -> bool:
        """Return whether the properties of all steps are kept or compared."""
        return self._keep_states

    def begin_state(self, step: int) -> None:
        """The properties of a step follow, those of objects that enter within it last."""
        self._step = step
        self._state = []
        if self._keep_states:
            self._states.append(self._state)

    def note(self, simulation: Any, obj: object, names: Sequence[str]) -> None:
        """Record the properties of one object; raises `DivergenceError` where they differ from the replayed ones."""
        if not self._keep_states:
            return
        for name in names:
            value = getattr(obj, name)
            numbers = _numbers(value)
            if numbers is None:
                continue
            begin = len(self._state)
            self._state.extend(numbers)
            if self._earlier is None or not self.replaying or self._step >= len(self._earlier.states):
                continue
            recorded_numbers = self._earlier.states[self._step][begin : begin + len(numbers)]
            old, new = _shaped(recorded_numbers, value), value
            if len(recorded_numbers) != len(numbers) or simulation.valuesHaveDiverged(obj, name, old, new):
                number = simulation.objects.index(obj)
                self._diverged(f"{name} of object {number} is {new!r}, was {old!r}")

    def differ(self, expected: object, actual: object) -> bool:
        """Return whether two values of a property differ by more than the tolerance."""
        first, second = _numbers(expected), _numbers(actual)
        if first is None or second is None or len(first) != len(second):
            return bool(expected != actual)
        return any(abs(one - other) > self._tolerance for one, other in zip(first, second, strict=True))

    def replay(self) -> Replay:
        """Return the recording of the simulation."""
        made = [] if self.draws is None or not self._keep_draws else list(self.draws.made)
        return Replay(self._key, made, self._states)


class _Switch(Seeded):
    """The numbers that a tape gives."""

    def __init__(self, tape: Tape) -> None:
        super().__init__(tape.key)
        self._tape = tape

    def draw(self, place: int, what: Draw) -> float:
        """The number at an address."""
        return self._tape.draw(place, what)


def _numbers(value: object) -> list[float] | None:
    if is_number(value):
        return [float(value)]
    if isinstance(value, Vector):
        return list(value)
    if isinstance(value, Orientation):
        return [value.x, value.y, value.z, value.w]
    return None


def _shaped(numbers: Sequence[float], like: object) -> Any:
    if isinstance(like, Vector) and len(numbers) == 3:
        return Vector.of(tuple(numbers))
    if isinstance(like, Orientation) and len(numbers) == 4:
        return Orientation.of(tuple(numbers))
    return numbers[0] if len(numbers) == 1 else tuple(numbers)
