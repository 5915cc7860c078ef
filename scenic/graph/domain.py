"""The part of the unit cube to sample from: a union of boxes, or a product of several."""

import math
from dataclasses import field
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.draws import Words, box_addresses
from scenic.graph.finite import Finite

Floats = NDArray[np.float64]

FIRST: Final = 5e-324
LAST: Final = 1 - 2.0**-53
"""The outermost points of the open unit interval."""


@dataclass(frozen=True, slots=True, eq=False)
class Domain:
    """A union of boxes of the unit cube that share no volume.

    ``lower`` and ``upper``, both of shape ``(m, dimension)`` with ``0 <= lower < upper <= 1``, are the corners of the
    ``m >= 1`` boxes. Uniform points of the union are points of the cube conditioned to lie in it, which leaves every law
    conditioned on the requirements unchanged as long as the union holds all points that meet them.

    ``factors`` are further unions, each of which narrows axes that no other does: the domain is what lies in all of them. So
    what is asked of a hundred things, each by itself, takes a hundred small unions rather than one that nobody could write down.

    ``finite`` are sets of further axes, of discrete values, whose cells are chosen together.
    """

    lower: Floats
    upper: Floats
    factors: tuple["Domain", ...] = ()
    finite: tuple[Finite, ...] = ()
    _narrowed: NDArray[np.bool_] = field(init=False, repr=False)
    """A mask of the axes that each part narrows, ``(parts, dimension)``."""
    _cells: dict[int, tuple[int, Floats, Floats]] = field(init=False, repr=False)
    """Of the axes of finite parts: the row of what `choose` returns that has their cells, and the ends of these."""

    def __post_init__(self) -> None:
        if self.lower.ndim != 2 or self.lower.shape != self.upper.shape or len(self.lower) == 0:
            raise ValueError(f"not boxes: corners of shapes {self.lower.shape} and {self.upper.shape}")
        if not ((self.lower >= 0) & (self.lower < self.upper) & (self.upper <= 1)).all():
            raise ValueError("a box of the cube must have volume and lie within it")
        narrow_axes = np.stack([((part.lower > 0) | (part.upper < 1)).any(axis=0) for part in self.parts])
        times = narrow_axes.sum(axis=0)
        for one in self.finite:
            times[one.axes] += 1
        if (times > 1).any():
            raise ValueError("two factors narrow one axis")
        object.__setattr__(self, "_narrowed", narrow_axes)
        cells: dict[int, tuple[int, Floats, Floats]] = {}
        for one in self.finite:
            for axis, lower, upper in zip(one.axes.tolist(), one.lower, one.upper, strict=True):
                cells[axis] = len(self.parts) + len(cells), lower, upper
        object.__setattr__(self, "_cells", cells)

    @classmethod
    def whole(cls, dimension: int) -> Self:
        """Return the whole cube."""
        return cls(np.zeros((1, dimension)), np.ones((1, dimension)))

    @property
    def dimension(self) -> int:
        """Number of axes of the cube."""
        return int(self.lower.shape[1])

    @property
    def boxes(self) -> int:
        """Number of boxes (of the first factor)."""
        return len(self.lower)

    @property
    def parts(self) -> tuple["Domain", ...]:
        """All factors, from the first on."""
        return (self, *self.factors)

    @property
    def is_whole(self) -> bool:
        """Return whether nothing of the cube is left out."""
        return not self.finite and all(
            len(part.lower) == 1 and bool((part.lower == 0).all() and (part.upper == 1).all())
            for part in self.parts
        )

    @property
    def volume(self) -> float:
        """Share of the cube that is left."""
        boxes = math.prod(float(np.exp(part._logarithms()).sum()) for part in self.parts)
        return boxes * math.prod(one.share for one in self.finite)

    def _logarithms(self) -> Floats:
        """Return the logarithm of each box's volume; with many axes the volume itself may be too small for a float."""
        return np.asarray(np.log(self.upper - self.lower).sum(axis=1))

    @property
    def hull(self) -> tuple[Floats, Floats]:
        """Corners ``(1, dimension)`` of the smallest box that holds all boxes."""
        lower, upper = np.zeros((1, self.dimension)), np.ones((1, self.dimension))
        for part in self.parts:
            lower = np.maximum(lower, part.lower.min(axis=0, keepdims=True))
            upper = np.minimum(upper, part.upper.max(axis=0, keepdims=True))
        for one in self.finite:
            lower[0, one.axes], upper[0, one.axes] = one.ends
        return lower, upper

    def joined_axes(self) -> list[NDArray[np.intp]]:
        """Return the groups of axes that are drawn together.

        Each part has a group: the axes that its boxes do not all narrow alike. Each finite part has another one.
        """
        boxes = [
            np.flatnonzero(((part.lower != part.lower[0]) | (part.upper != part.upper[0])).any(axis=0))
            for part in self.parts
        ]
        return boxes + [one.axes for one in self.finite]

    def addresses(self) -> list[Words]:
        """The addresses of the numbers by which axes that are drawn together are chosen, in the order of `joined_axes`."""
        boxes = box_addresses(len(self.parts))
        return [boxes[place : place + 1] for place in range(len(boxes))] + [
            one.addresses for one in self.finite
        ]

    def freed(self, axes: NDArray[np.bool_]) -> "Domain":
        """Return a domain that holds this one and narrows none of some axes ``(dimension,)``."""

        def part(one: "Domain") -> tuple[Floats, Floats]:
            lower, upper = one.lower, one.upper
            alike = (lower[:, axes] == lower[0, axes]).all() and (upper[:, axes] == upper[0, axes]).all()
            if alike:
                lower, upper = np.where(axes, 0.0, lower), np.where(axes, 1.0, upper)
            else:
                # Boxes that differ in these axes may overlap without them: what remains is the box about them all.
                lower, upper = lower.min(axis=0, keepdims=True), upper.max(axis=0, keepdims=True)
                lower[:, axes], upper[:, axes] = 0, 1
            return lower, upper

        first, *others = (part(one) for one in self.parts)
        finite_parts = tuple(one for one in self.finite if not axes[one.axes].any())
        return Domain(*first, tuple(Domain(*corners) for corners in others), finite_parts)

    def narrowing(self) -> list[list[int]]:
        """Of each axis the numbers of the parts that narrow it; finite parts are numbered after all others."""
        result: list[list[int]] = [[] for _ in range(self.dimension)]
        for part, axis in np.argwhere(self._narrowed).tolist():
            result[axis].append(part)
        for number, one in enumerate(self.finite, len(self.parts)):
            for axis in one.axes.tolist():
                result[axis].append(number)
        return result

    def along(self, axes: NDArray[np.intp]) -> tuple["Domain", dict[int, int]]:
        """Return the domain as far as it narrows some axes, which it draws jointly with no others.

        Returns:
            That domain, and for the addresses by which it chooses boxes those by which this one does.

        """
        is_wanted = np.zeros(self.dimension, dtype=np.bool_)
        is_wanted[axes] = True
        places, corners = [], []
        for number, part in enumerate(self.parts):
            if (self._narrowed[number] & is_wanted).any():
                places.append(number)
                corners.append((np.where(is_wanted, part.lower, 0.0), np.where(is_wanted, part.upper, 1.0)))
        finite = tuple(one for one in self.finite if is_wanted[one.axes].any())
        first, *others = corners or [(np.zeros((1, self.dimension)), np.ones((1, self.dimension)))]
        result = Domain(*first, tuple(Domain(*each) for each in others), finite)
        addresses = box_addresses(len(self.parts)).tolist()
        new_addresses = dict(
            zip(box_addresses(len(places)).tolist(), (addresses[place] for place in places), strict=False)
        )
        return result, new_addresses

    def with_finite(self, finite: tuple[Finite, ...]) -> "Domain":
        """Return the domain in which the axes of finite parts are chosen by these."""
        axes = np.zeros(self.dimension, dtype=np.bool_)
        for one in finite:
            axes[one.axes] = True
        freed = self.freed(axes) if axes.any() else self
        return Domain(freed.lower, freed.upper, freed.factors, (*freed.finite, *finite))

    def choose(self, draws: Floats) -> NDArray[np.intp]:
        """Boxes and cells chosen by uniform numbers of the open unit interval, ``(m, n)``.

        Args:
            draws: those of all `addresses`, one after the other.

        Returns:
            For each part the number of a box, then for each axis of the finite parts the number of a cell.

        """
        count = len(self.parts)
        boxes = np.stack(
            [part._choose(numbers) for part, numbers in zip(self.parts, draws[:count], strict=True)]
        )
        if not self.finite:
            return boxes
        rows, start = [boxes], count
        for one in self.finite:
            rows.append(one.law.choose(draws[start : start + len(one.addresses)]))
            start += len(one.addresses)
        return np.concatenate(rows)

    def _choose(self, draws: Floats) -> NDArray[np.intp]:
        if self.boxes == 1:
            return np.zeros(len(draws), dtype=np.intp)
        return np.minimum(np.searchsorted(self._shares(), draws, side="right"), self.boxes - 1)

    def place(self, numbers: Floats, axes: NDArray[np.intp], chosen: NDArray[np.intp]) -> Floats:
        """Map uniform numbers of some axes, ``(axes, n)``, into the boxes ``chosen`` for the lanes, ``(parts, n)``.

        With all axes these are uniform points of the domain. Each number depends on its axis and its lane alone.
        ``chosen`` is what `choose` returns.
        """
        if not self.factors:
            points = self._place(numbers, axes, chosen[0])
        else:
            points = numbers.copy()
            for part, narrow_axes, boxes in zip(self.parts, self._narrowed, chosen, strict=False):
                mine = np.flatnonzero(narrow_axes[axes])
                if len(mine):
                    points[mine] = part._place(numbers[mine], axes[mine], boxes)
        if self._cells:
            for row, axis in enumerate(axes.tolist()):
                if axis in self._cells:
                    place, lower, upper = self._cells[axis]
                    points[row] = _between(numbers[row], lower[chosen[place]], upper[chosen[place]])
        return points

    def _place(self, numbers: Floats, axes: NDArray[np.intp], chosen: NDArray[np.intp]) -> Floats:
        lower, upper = self.lower[:, axes], self.upper[:, axes]
        if self.boxes == 1:
            return _between(numbers, lower[0, :, np.newaxis], upper[0, :, np.newaxis])
        points = _between(numbers, lower[0, :, np.newaxis], upper[0, :, np.newaxis])
        # Boxes differ in few axes; only those are looked up lane by lane.
        for row in np.flatnonzero((lower != lower[0]).any(axis=0) | (upper != upper[0]).any(axis=0)):
            points[row] = _between(numbers[row], lower[chosen, row], upper[chosen, row])
        return points

    def place_each(self, numbers: Floats, axes: NDArray[np.intp], chosen: NDArray[np.intp]) -> Floats:
        """The same for numbers ``(n,)`` of one axis in each lane, ``(n,)``."""
        points = numbers
        for part, boxes in zip(self.parts, chosen, strict=False):
            points = _between(points, part.lower[boxes, axes], part.upper[boxes, axes])
        for axis, (row, lower, upper) in self._cells.items():
            mine = np.flatnonzero(axes == axis)
            cells = chosen[row][mine]
            points[mine] = _between(numbers[mine], lower[cells], upper[cells])
        return points

    def _shares(self) -> Floats:
        logarithms = self._logarithms()
        volumes = np.exp(logarithms - logarithms.max())
        return np.asarray(np.cumsum(volumes) / volumes.sum())

    def contains(self, points: Floats) -> NDArray[np.bool_]:
        """The mask ``(n,)`` of the points of the cube, shape ``(n, dimension)``, that lie in the domain."""
        everywhere = np.ones(len(points), dtype=np.bool_)
        for part in self.parts:
            inside = np.zeros(len(points), dtype=np.bool_)
            for lower, upper in zip(part.lower, part.upper, strict=True):
                inside |= ((points >= lower) & (points <= upper)).all(axis=1)
            everywhere &= inside
        for one in self.finite:
            everywhere &= one.contains(points)
        return everywhere

    def to_data(self) -> dict[str, Any]:
        """Return plain data for a manifest: the axes that are narrowed, by number, box by box."""
        first, *factors = (part._boxes_to_data() for part in self.parts)
        return {"dimension": self.dimension, "boxes": first, **({"factors": factors} if factors else {})}

    def _boxes_to_data(self) -> list[dict[str, list[float]]]:
        boxes = []
        for lower, upper in zip(self.lower.tolist(), self.upper.tolist(), strict=True):
            ends = enumerate(zip(lower, upper, strict=True))
            boxes.append({str(axis): [low, high] for axis, (low, high) in ends if (low, high) != (0.0, 1.0)})
        return boxes

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> Self:
        """Return the domain of `to_data`; raises ``ValueError`` for data that describes none."""
        try:
            dimension, boxes = int(data["dimension"]), data["boxes"]
            factors = tuple(
                cls.from_data({"dimension": dimension, "boxes": boxes}) for boxes in data.get("factors", ())
            )
            lower, upper = np.zeros((len(boxes), dimension)), np.ones((len(boxes), dimension))
            for number, box in enumerate(boxes):
                for axis, (low, high) in box.items():
                    if int(axis) < 0:
                        raise IndexError(f"axis {axis}")
                    lower[number, int(axis)], upper[number, int(axis)] = low, high
        except (KeyError, TypeError, IndexError, AttributeError) as error:
            raise ValueError(f"not a domain: {error}") from error
        return cls(lower, upper, factors)


def _between(rows: Floats, lower: Floats, upper: Floats) -> Floats:
    points = lower + (upper - lower) * rows
    return np.clip(points, np.maximum(lower, FIRST), np.minimum(upper, LAST))
