"""What of a program an external sampler may choose."""

from dataclasses import dataclass

__all__ = ["Choosable"]


@dataclass(frozen=True, slots=True)
class Choosable:
    """An axis of the cube whose number a search may choose.

    Attributes:
        kind: the name of what the program has called.
        low: the least value; of options the first place.
        high: the greatest one.
        count: of integers and options, how many there are.
        shares: the prior: probabilities of the values, or of buckets of equal width; ``None`` if there are no buckets.

    """

    kind: str
    low: float
    high: float
    count: int | None
    shares: tuple[float, ...] | None
