"""Splitting boxes of the cube where few of their points can meet the conditions.

Where a condition couples axes, as an angle and a place in a narrow corridor, halving them one after the other may show nothing
for many rounds. So the axis to split is tried out: the one whose parts lose most. Everything is counted, never timed.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.boxes import Boxes
from scenic.graph.bounds import Floats

Contract = Callable[[Boxes], Boxes]
"""Narrows boxes, and leaves out those that hold no solution."""

Narrow = Callable[[Boxes], tuple[Boxes, NDArray[np.intp]]]
"""The same, and which of the boxes are left."""

RARE: Final = 0.5
"""Boxes are split by trial where fewer than this share of their points may meet the conditions."""

POINTS: Final = 256
"""Number of points that estimate this share."""

MOST: Final = 1024
"""Boxes, at most; three times as many where hardly any point may meet the conditions."""

HARDLY_ANY: Final = 0.01
"""The share that counts as hardly any."""

CUT: Final = 256
"""Boxes, at most, that cutting into more than halves gives."""

TRIED: Final = 16
"""Boxes up to which every axis is tried."""

SECTIONS: Final = 16
"""Parts into which boxes are cut along an axis where halves lose nothing."""

LOSS: Final = 0.01
"""The least share of the volume that counts as lost."""

MUCH: Final = 0.04
"""The share above which boxes that lose nothing wait, while others lose so much."""

LOSS_OF_ONE: Final = 0.001
"""The same for a single box among many: those that lose less are no longer split."""

TURNS: Final = 128
"""Times that boxes are split, at most: where each loses a little, as in the tail of a normal distribution, they would go on for long."""

ENOUGH: Final = 1.1
"""Splitting that is costly ends where the boxes have less than so many times the volume of the points that may meet the conditions."""

NEARLY_ENOUGH: Final = 1.8
"""It also ends where they have less than so many times this volume, and the last `IDLE` rounds lost less than `WORTHWHILE` each."""

IDLE: Final = 2

WORTHWHILE: Final = 0.05
"""The share of the volume that a round should lose then."""

RELIABLE: Final = 16
"""Points that may meet the conditions, at least, by which that volume is estimated."""

VAIN: Final = 3
"""Rounds without a loss, of many boxes, after which splitting ends."""


def share_that_may_hold(
    contract: Contract, hull: Boxes, axes: NDArray[np.intp], points: int = POINTS
) -> float:
    """About the share of points of a box that may meet the conditions, by points that are spread evenly along some axes."""
    # The additive sequence of the generalised golden ratio (M. Roberts, "The unreasonable effectiveness of
    # quasirandom sequences", 2018).
    ratio = 2.0
    for _ in range(64):
        ratio = (1 + ratio) ** (1 / (len(axes) + 1))
    steps = ratio ** -np.arange(1.0, len(axes) + 1)
    places = np.mod(0.5 + np.arange(1, points + 1)[:, np.newaxis] * steps, 1.0)
    lower, upper = np.tile(hull.lower[:1], (points, 1)), np.tile(hull.upper[:1], (points, 1))
    grid_points = lower[:, axes] + (upper[:, axes] - lower[:, axes]) * places
    lower[:, axes] = upper[:, axes] = grid_points
    return len(contract(Boxes(lower, upper))) / points


def pave_by_trial(
    narrow: Narrow,
    hull: Boxes,
    axes: NDArray[np.intp],
    share: float,
    cuts: Mapping[int, Floats],
    is_costly: Callable[[], bool],
    is_spent: Callable[[], bool],
) -> Boxes:
    """Return boxes that contain all solutions in a box.

    Args:
        narrow: narrows boxes.
        hull: the box.
        axes: those below the conditions.
        share: how many of its points may meet the conditions.
        cuts: by axis, where values change that are the same between: boxes are cut there first.
        is_costly: tells when so much work was done that more has to be worth it.
        is_spent: tells when no more work may be done.

    """

    def contract(some: Boxes) -> Boxes:
        return narrow(some)[0]

    boxes, vain = hull, 0
    least, last, idle = share * hull.volume(axes), math.inf, 0
    split = axes.tolist()
    for axis, places in cuts.items():
        if axis in split and len(boxes) * (len(places) + 1) <= CUT:
            boxes = contract(boxes.cut(axis, places))
            split.remove(axis)
    useful = np.array(split, dtype=np.intp)
    most = MOST if share > HARDLY_ANY else 3 * MOST
    for _ in range(TURNS):
        if not split or not 0 < 2 * len(boxes) <= most or is_spent():
            break
        if vain == VAIN:
            if len(useful) == len(split):
                break
            useful, vain = np.array(split, dtype=np.intp), 0  # what gained nothing at first may now
        volume = boxes.volume(axes)
        ratio = volume / least if share * POINTS >= RELIABLE else math.inf
        if is_costly():
            idle = idle + 1 if volume > (1 - WORTHWHILE) * last else 0
            if ratio <= ENOUGH or (ratio <= NEARLY_ENOUGH and idle >= IDLE):
                break
        best = None
        if len(boxes) <= TRIED:
            for ways in _ways(split, len(boxes)):
                trials = [contract(_cut_along(boxes, way)) for way in ways]
                left = [each.volume(axes) for each in trials]
                losing = [way for way, rest in zip(ways, left, strict=True) if rest < (1 - LOSS) * volume]
                if losing:
                    best = trials[int(np.argmin(left))]
                    useful = np.array(sorted({axis for way in losing for axis, _ in way}), dtype=np.intp)
                    break
        if best is None:
            best = _refined(narrow, boxes, useful, axes)
            vain = vain + 1 if len(boxes) > TRIED and best.volume(axes) > (1 - LOSS) * volume else 0
        last = volume
        boxes = best
    return boxes


Way = Sequence[tuple[int, int]]
"""Axes, each with the number of parts into which boxes are cut along it."""


def _ways(axes: Sequence[int], count: int) -> Iterator[list[Way]]:
    """Ways to cut a number of boxes, cheap ones first: in halves, in sections, in sections along two axes."""
    yield [[(axis, 2)] for axis in axes]
    if count * SECTIONS <= CUT:
        yield [[(axis, SECTIONS)] for axis in axes]
    parts = SECTIONS // 2 if count * SECTIONS * 4 <= CUT else SECTIONS // 4
    if count * parts * parts <= CUT:
        yield [[(one, parts), (two, parts)] for one, two in combinations(axes, 2)]


def _cut_along(boxes: Boxes, way: Way) -> Boxes:
    for axis, parts in way:
        boxes = boxes.divided(np.full(len(boxes), axis), parts)
    return boxes


def _refined(narrow: Narrow, boxes: Boxes, axes: NDArray[np.intp], every: NDArray[np.intp]) -> Boxes:
    """Halve each box along the one of some axes that loses most; boxes that lose nothing remain as they are.

    Where they hardly lose anything together, all are halved along their widest axes.
    """
    volume = boxes.volumes(every)
    halves = [narrow(boxes.divided(np.full(len(boxes), axis))) for axis in axes]
    parents = [rows % len(boxes) for _, rows in halves]
    left = np.stack(
        [
            np.bincount(rows, weights=parts.volumes(every), minlength=len(boxes))
            for (parts, _), rows in zip(halves, parents, strict=True)
        ]
    )
    way_of_box = np.where(left.min(axis=0) < (1 - LOSS_OF_ONE) * volume, left.argmin(axis=0), -1)
    if np.minimum(left.min(axis=0), volume).sum() > (1 - LOSS) * volume.sum():
        return narrow(boxes.divided(_widest(boxes, axes)))[0]
    others = boxes.taken(np.flatnonzero(way_of_box < 0))
    if len(others) and np.minimum(left.min(axis=0), volume).sum() > (1 - MUCH) * volume.sum():
        others = narrow(others.divided(_widest(others, axes)))[0]
    parts_of_boxes = [others]
    for number, ((parts, _), rows) in enumerate(zip(halves, parents, strict=True)):
        parts_of_boxes.append(parts.taken(np.flatnonzero(way_of_box[rows] == number)))
    return Boxes.joined(parts_of_boxes)


def _widest(boxes: Boxes, axes: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the one of some axes along which each box is widest, ``(m,)``."""
    widest: NDArray[np.intp] = axes[(boxes.upper - boxes.lower)[:, axes].argmax(axis=1)]
    return widest


__all__ = ["POINTS", "RARE", "pave_by_trial", "share_that_may_hold"]
