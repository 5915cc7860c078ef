"""Paths of cars: smooth curves along lanes, made of pieces that every car on a network shares.

A piece leads from the middle of one lane to the middle of another one, through the connecting lanes and short lanes between
them. It begins and ends on the curve of the lane alone, so that pieces fit each other without a step in curvature.
"""

import math
import time
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import Lane
from scenic.domains.driving.narrow_lanes import line_to_drive
from scenic.domains.driving.path_pieces import PathPiece, piece_along
from scenic.domains.driving.path_smoothing import SPACING, TIGHTEST, resampled, smoothed
from scenic.domains.driving.piece_store import PieceKey, keep_pieces, kept_pieces

__all__ = ["Path", "PathPieces", "is_long"]

Floats = NDArray[np.float64]

_LONG: Final = 24.0
"""Metres from which a lane is long enough for a path to be cut in its middle."""
_ABOUT: Final = 12.0
"""Metres along a path within which a place is looked for that is known roughly."""
_WORTH: Final = 0.05
"""Seconds of smoothing from which on its results are kept."""
_SHARE: Final = 10
"""Times that keeping pieces takes which are spent on others before all are kept again."""
_ROUTES: Final = 256
"""Routes whose pieces are kept."""
_SHARED: Final = 4
"""Points that neighbouring pieces share: they fix position, heading and curvature."""


def is_long(lane: Lane) -> bool:
    """Return whether paths can be cut in the middle of a lane."""
    return _length(lane.line) >= _LONG


def _length(line: Floats) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


class PathPieces:
    """The pieces of paths on a network, made when a car first needs them, and kept in the store on disk.

    Args:
        backward: pieces against the direction of lanes.
        tightest: curvature (1/m) that they may have.
        origin: the digest of the network; ``None`` if it is not known, and nothing is kept.
        lanes: the lanes of the network by ``uid``.

    """

    def __init__(
        self,
        *,
        backward: bool = False,
        tightest: float = TIGHTEST,
        origin: bytes | None = None,
        lanes: Mapping[str, Any] | None = None,
    ) -> None:
        self._backward, self._tightest = backward, tightest
        self._curves: dict[str, tuple[Floats, Floats]] = {}
        self._content = None if origin is None else origin + repr((backward, tightest)).encode()
        self._pieces = {} if self._content is None else kept_pieces(self._content, lanes or {})
        self._spent, self._worth = 0.0, _WORTH
        self._routes: dict[bytes, PathPiece] = {}

    def _line(self, lane: Lane) -> Floats:
        line = line_to_drive(lane)
        return line[::-1] if self._backward else line

    def _curve(self, lane: Lane) -> tuple[Floats, Floats]:
        """Points on a lane's centerline, and on the smooth curve along the lane alone."""
        curve = self._curves.get(lane.uid)
        if curve is None:
            points = resampled(self._line(lane))
            curve = self._curves[lane.uid] = points, smoothed(points, tightest=self._tightest)
        return curve

    def start(self, lane: Lane) -> PathPiece:
        """Return the first half of a long lane."""
        return self._known(("start", lane.uid), lambda: self._half(lane, first=True))

    def end(self, lane: Lane) -> PathPiece:
        """Return the second half of a long lane."""
        return self._known(("end", lane.uid), lambda: self._half(lane, first=False))

    def between(self, lanes: Sequence[Lane], *, opens: bool, closes: bool) -> PathPiece:
        """Return the piece along several lanes.

        Args:
            lanes: one after the other.
            opens: begin in the middle of the first lane, rather than at its beginning.
            closes: end in the middle of the last lane.

        """
        key: PieceKey = (opens, closes, *(lane.uid for lane in lanes))
        return self._known(key, lambda: self._through(lanes, opens=opens, closes=closes))

    def along(self, lines: Sequence[Floats]) -> PathPiece:
        """Return the piece along lines ``(n, 2)`` of a route, one after the other; those of the last routes are kept."""
        points = np.concatenate(lines)
        key = points.tobytes()
        piece = self._routes.get(key)
        if piece is None:
            if len(self._routes) >= _ROUTES:
                self._routes.clear()
            piece = self._routes[key] = piece_along(smoothed(resampled(points), tightest=self._tightest))
        return piece

    def _known(self, key: PieceKey, make: Callable[[], PathPiece]) -> PathPiece:
        piece = self._pieces.get(key)
        if piece is None:
            begun = time.process_time()
            piece = self._pieces[key] = make()
            self._spent += time.process_time() - begun
            if self._content is not None and self._spent > self._worth:
                self._keep(self._content)
        return piece

    def _keep(self, content: bytes) -> None:
        """Keep all pieces, and wait with the next time until that takes but a part of what it may save."""
        begun = time.process_time()
        keep_pieces(content, self._pieces)
        self._spent, self._worth = 0.0, max(_WORTH, _SHARE * (time.process_time() - begun))

    def _half(self, lane: Lane, *, first: bool) -> PathPiece:
        _, curve = self._curve(lane)
        middle = len(curve) // 2
        if first:
            return piece_along(curve[: middle + 1], [(0, lane)], cut=(0, 1))
        return piece_along(curve[middle - 1 :], [(0, lane)], cut=(1, 0))

    def _through(self, lanes: Sequence[Lane], *, opens: bool, closes: bool) -> PathPiece:
        first = last = None
        before = after = np.empty((0, 2))
        inner = list(lanes)
        marks: list[tuple[int, Any]] = []
        if opens:
            raw, curve = self._curve(inner.pop(0))
            middle = len(raw) // 2
            before, first = raw[middle - 2 :], curve[middle - 2 : middle - 2 + _SHARED]
            marks.append((0, lanes[0]))
        if closes:
            raw, curve = self._curve(inner.pop())
            middle = len(raw) // 2
            after, last = raw[: middle + 2], curve[middle + 2 - _SHARED : middle + 2]
            if opens and not inner and np.hypot(*(after[0] - before[-1])) < SPACING / 2:
                # Two points in one place have no direction.
                after = after[1:]
        lines = [before[-1:], *map(self._line, inner), after[:1]]
        way = np.concatenate(lines)
        middle_part = resampled(way) if _length(way) > SPACING else way[:0]
        begin = before if opens else middle_part[:1]
        finish = after if closes else middle_part[-1:]
        points = np.concatenate([begin, middle_part[1:-1], finish])
        sizes = np.array([_length(self._line(lane)) for lane in inner])
        shares = np.concatenate([[0.0], np.cumsum(sizes)]) / max(float(sizes.sum()), 1e-9)
        offset = len(begin)
        marks += [
            (offset + round(share * len(middle_part)), lane)
            for share, lane in zip(shares, inner, strict=False)
        ]
        if closes:
            marks.append((len(points) - len(after), lanes[-1]))
        curve = smoothed(points, first, last, self._tightest)
        return piece_along(curve, marks, cut=(2 if opens else 0, 2 if closes else 0))


class Path:
    """A curve that a car follows: points about half a metre apart, to which pieces are added at the end.

    Attributes:
        along: metres along the path to each point.
        headings: at each point, radians, anticlockwise from north, without jumps.
        curvatures: at each point, in 1/m, positive to the left.
        bends: curvatures of the pieces alone, without what the path has been bent by for a car to join it.
        lanes: the lanes along the path, with the index of the first point of each.

    """

    __slots__ = ("_x", "_y", "along", "bends", "curvatures", "headings", "lanes")

    def __init__(self, piece: PathPiece | None = None) -> None:
        self._x: list[float] = []
        self._y: list[float] = []
        self.along: list[float] = []
        self.headings: list[float] = []
        self.curvatures: list[float] = []
        self.bends: list[float] = []
        self.lanes: list[tuple[int, Any]] = []
        if piece is not None:
            self.extend(piece)

    @property
    def length(self) -> float:
        """Metres from the first point to the last one."""
        return self.along[-1] if self.along else 0.0

    def extend(self, piece: PathPiece) -> None:
        """Add a piece, which begins where the path ends."""
        points = piece.points
        if not len(points):
            return
        turns = 0.0
        count = len(self.along)
        if count:
            turns = 2 * math.pi * round((self.headings[-1] - float(piece.headings[0])) / (2 * math.pi))
            points = np.vstack([[self._x[-1], self._y[-1]], points])
        lengths = np.cumsum(np.maximum(np.hypot(*np.diff(points, axis=0).T), 1e-6))
        if count:
            self.along.extend((lengths + self.along[-1]).tolist())
        else:
            self.along = [0.0, *lengths.tolist()]
        self._x.extend(piece.points[:, 0].tolist())
        self._y.extend(piece.points[:, 1].tolist())
        self.headings.extend((piece.headings + turns).tolist())
        self.curvatures.extend(piece.curvatures.tolist())
        self.bends.extend(piece.curvatures.tolist())
        self.lanes.extend((count + index, lane) for index, lane in piece.lanes)

    def copy(self) -> "Path":
        """A path of the same points, which can be bent and extended on its own."""
        other = Path()
        for name in Path.__slots__:
            setattr(other, name, list(getattr(self, name)))
        return other

    def points(self) -> Floats:
        """The points ``(n, 2)``."""
        return np.column_stack([self._x, self._y])

    def stretch(self, begin: int, end: int) -> Floats:
        """The points ``(k, 2)`` from one index to another one."""
        return np.array([self._x[begin:end], self._y[begin:end]]).T

    def locate(self, x: float, y: float, index: int) -> tuple[int, float, float]:
        """The place of the path that is nearest to a point, looked for from a point of the path on.

        Returns:
            The index of the point before the place, the share of the way to the next point (outside of 0 to 1 beyond the ends of
            the path), and the distance of the point from the path in metres, positive to the left.

        """
        xs, ys, last = self._x, self._y, len(self._x) - 2
        index = min(max(index, 0), last)
        direction = 0
        while True:
            x0, y0 = xs[index], ys[index]
            dx, dy = xs[index + 1] - x0, ys[index + 1] - y0
            a, b = x - x0, y - y0
            share = (a * dx + b * dy) / (dx * dx + dy * dy)
            if share > 1.0 and index < last and direction >= 0:
                index += 1
                direction = 1
            elif share < 0.0 and index > 0 and direction <= 0:
                index -= 1
                direction = -1
            else:
                return index, share, (dx * b - dy * a) / math.sqrt(dx * dx + dy * dy)

    def nearest(self, x: float, y: float, near: float | None = None) -> int:
        """The index of the point of the path that is nearest to a place; of those about metres along the path, if given."""
        low, high = 0, len(self.along)
        if near is not None:
            # Smooth paths are a little shorter than the lines of their lanes.
            reach = _ABOUT + near / 20
            low = min(bisect_left(self.along, near - reach), high - 1)
            high = max(bisect_right(self.along, near + reach), low + 1)
        away = (np.array(self._x[low:high]) - x) ** 2 + (np.array(self._y[low:high]) - y) ** 2
        return low + int(away.argmin())

    def along_at(self, x: float, y: float, index: int) -> float:
        """Metres along the path to the place of it that is nearest to a point, looked for from a point of the path on."""
        index, share, _ = self.locate(x, y, index)
        return self.along[index] + min(max(share, 0.0), 1.0) * (self.along[index + 1] - self.along[index])

    def index_at(self, along: float, index: int) -> int:
        """The index of the last point at or before a place metres along the path, looked for from a point of the path on."""
        lengths, last = self.along, len(self.along) - 2
        if lengths[index] <= along:
            return min(bisect_right(lengths, along, index) - 1, last)
        return max(bisect_right(lengths, along, 0, index) - 1, 0)

    def place(self, along: float, index: int = 0) -> tuple[float, float]:
        """The coordinates of a place metres along the path; beyond the ends the path goes on straight."""
        index = self.index_at(along, index)
        share = (along - self.along[index]) / (self.along[index + 1] - self.along[index])
        x, y = self._x[index], self._y[index]
        return x + share * (self._x[index + 1] - x), y + share * (self._y[index + 1] - y)

    def lane_number(self, index: int) -> int:
        """Return the number of the lane in `lanes` along which the path runs at a point; -1 off the lanes."""
        return bisect_right(self.lanes, index, key=_first_point) - 1

    def lane_at(self, index: int) -> Any:
        """Return the lane along which the path runs at a point; ``None`` off the lanes."""
        number = self.lane_number(index)
        return self.lanes[number][1] if number >= 0 else None

    def shifted(self, begin: int, offsets: Floats) -> None:
        """Shift the points from an index on to the left, by metres ``(k,)``, and bend the path accordingly."""
        end = begin + len(offsets)
        headings = np.array(self.headings[begin:end])
        x = np.array(self._x[begin:end]) - offsets * np.cos(headings)
        y = np.array(self._y[begin:end]) - offsets * np.sin(headings)
        self._x[begin:end], self._y[begin:end] = x.tolist(), y.tolist()
        low, high = max(0, begin - 2), min(len(self._x), end + 2)
        # What the ends of a piece are like is known only from the points beyond them.
        cut = (1 if low else 0, 1 if high < len(self._x) else 0)
        piece = piece_along(self.stretch(low, high), cut=cut)
        low, high = low + cut[0], high - cut[1]
        turns = 2 * math.pi * round((self.headings[low] - float(piece.headings[0])) / (2 * math.pi))
        self.headings[low:high] = (piece.headings + turns).tolist()
        self.curvatures[low:high] = piece.curvatures.tolist()
        steps = np.hypot(*np.diff(self.points(), axis=0).T)
        self.along = [0.0, *np.cumsum(np.maximum(steps, 1e-6)).tolist()]


def _first_point(mark: tuple[int, Any]) -> int:
    return mark[0]
