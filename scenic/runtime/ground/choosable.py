"""Values of a program that an external sampler may choose."""

from scenic.dataclass import dataclass

__all__ = ["Choosable"]


@dataclass(frozen=True, slots=True)
class Choosable:
    """An axis of the cube whose number a search may choose.

    Attributes:
        kind: the name of what the program has called.
        low: the least value; of options the first place.
        high: the greatest one.
        count: of integers and options, how many are possible.
        shares: the prior: probabilities of the possible values, or of buckets; ``None`` if there are no buckets.
        cells: where weights of zero leave something out, what remains: the ends of each bucket, or each value twice.
        normal: mean and deviation of a normal prior, whose window is from ``low`` to ``high``.
        is_stratified: whether buckets come from a prior: samplers that do not learn draw the bucket, and from the prior within it.

    """

    kind: str
    low: float
    high: float
    count: int | None
    shares: tuple[float, ...] | None
    cells: tuple[tuple[float, float], ...] | None = None
    normal: tuple[float, float] | None = None
    is_stratified: bool = False
