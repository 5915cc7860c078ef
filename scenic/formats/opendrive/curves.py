"""Reference lines of roads: position, heading and curvature at any distance along them (section 3.3).

Lines and arcs are exact. Spirals are integrated by Gauss-Legendre quadrature, whose error is far below a micrometre for the steps
used here. The parameter of polynomials is found from the arc length on a table that is refined by Newton's method.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.formats.opendrive.records import Cubic, Geometry

__all__ = ["Curve", "cubic_bend", "cubic_values"]

Floats = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_TABLE: Final = 64
"""Intervals of the table from which the parameter of a polynomial follows."""


class Curve:
    """The reference line of a road.

    Args:
        pieces: its pieces, in order, the first at ``s = 0``.

    """

    def __init__(self, pieces: Sequence[Geometry]) -> None:
        self._pieces = tuple(pieces)
        self._starts = np.array([piece.s for piece in pieces])
        self.length = pieces[-1].s + pieces[-1].length
        """Metres."""
        self._polynomials = {
            index: _Polynomial(piece)
            for index, piece in enumerate(pieces)
            if piece.shape in ("poly3", "paramPoly3")
        }

    @property
    def breaks(self) -> Floats:
        """The positions at which the pieces begin and the last piece ends."""
        return np.append(self._starts, self.length)

    def at(self, s: Floats) -> tuple[Floats, Floats]:
        """Points ``(n, 2)`` and headings ``(n,)`` (anticlockwise from east) at sorted distances ``(n,)`` from the start."""
        points = np.empty((len(s), 2))
        headings = np.empty(len(s))
        owner = np.clip(np.searchsorted(self._starts, s, side="right") - 1, 0, None)
        edges = np.flatnonzero(np.diff(owner)) + 1
        for part in np.split(np.arange(len(s)), edges):
            if len(part):
                index = int(owner[part[0]])
                piece = self._pieces[index]
                points[part], headings[part] = self._piece_at(index, piece, s[part] - piece.s)
        return points, headings

    def tears(self) -> Floats:
        """Metres between the end of each piece but the last and where the next one begins, ``(pieces - 1,)``."""
        ends = [
            self._piece_at(index, piece, np.array([piece.length]))[0][0]
            for index, piece in enumerate(self._pieces[:-1])
        ]
        starts = np.array([(piece.x, piece.y) for piece in self._pieces[1:]])
        return np.hypot(*(starts - np.array(ends)).T) if ends else np.empty(0)

    def _piece_at(self, index: int, piece: Geometry, ds: Floats) -> tuple[Floats, Floats]:
        if piece.shape == "line":
            u, v, turn = ds, np.zeros_like(ds), np.zeros_like(ds)
        elif piece.shape == "arc":
            u, v, turn = _arc(piece.numbers[0], ds)
        elif piece.shape == "spiral":
            u, v, turn = _spiral(piece, ds)
        else:
            u, v, turn = self._polynomials[index].at(ds)
        cos, sin = np.cos(piece.heading), np.sin(piece.heading)
        points = np.stack([piece.x + u * cos - v * sin, piece.y + u * sin + v * cos], axis=-1)
        return points, piece.heading + turn

    def bends(self) -> list[tuple[float, float, float]]:
        """For each piece its start, its end, and the largest curvature on it, in 1/m."""
        rows = []
        for index, piece in enumerate(self._pieces):
            if piece.shape == "line":
                bend = 0.0
            elif piece.shape in ("arc", "spiral"):
                bend = max(map(abs, piece.numbers))
            else:
                bend = self._polynomials[index].bend
            rows.append((piece.s, piece.s + piece.length, bend))
        return rows


def _arc(curvature: float, ds: Floats) -> tuple[Floats, Floats, Floats]:
    turn = curvature * ds
    # sin(x) / x, also for arcs that are nearly straight.
    half = np.sinc(turn / (2 * np.pi))
    return ds * half * np.cos(turn / 2), ds * half * np.sin(turn / 2), turn


def _spiral(piece: Geometry, ds: Floats) -> tuple[Floats, Floats, Floats]:
    first, last = piece.numbers
    rate = (last - first) / piece.length

    def turned(s: Floats) -> Floats:
        return np.asarray(first * s + rate * s * s / 2)

    # Steps between the wanted places, divided so that the heading turns by less than half a radian in each.
    most = max(abs(first), abs(last), 1e-9)
    knots = np.concatenate([[0.0], ds])
    step = 0.5 / most
    counts = np.maximum(1, np.ceil(np.abs(np.diff(knots)) / step)).astype(int)
    starts = np.repeat(knots[:-1], counts)
    sizes = np.repeat(np.diff(knots) / counts, counts)
    first_of = np.concatenate([[0], np.cumsum(counts)[:-1]])
    offset = np.arange(len(starts)) - np.repeat(first_of, counts)
    starts = starts + offset * sizes
    inside = turned(starts[:, None] + (1 + _NODES) / 2 * sizes[:, None])
    u = np.cumsum((np.cos(inside) @ _WEIGHTS) / 2 * sizes)
    v = np.cumsum((np.sin(inside) @ _WEIGHTS) / 2 * sizes)
    ends = np.cumsum(counts) - 1
    return u[ends], v[ends], turned(ds)


class _Polynomial:
    """A polynomial piece: its parameter by arc length."""

    def __init__(self, piece: Geometry) -> None:
        if piece.shape == "poly3":
            a, b, c, d = piece.numbers
            self._u, self._v = np.array([0.0, 1, 0, 0]), np.array([a, b, c, d])
            end = piece.length
        else:
            self._u, self._v = np.array(piece.numbers[:4]), np.array(piece.numbers[4:])
            end = 1.0 if piece.normalized else piece.length
        self._length = piece.length
        self._du = self._u[1:] * (1, 2, 3)
        self._dv = self._v[1:] * (1, 2, 3)
        # A declared length may exceed that of the curve a little: then the curve goes on by itself.
        self._parameters = np.linspace(0, 1.25 * end, _TABLE + _TABLE // 4 + 1)
        middle = (self._parameters[:-1, None] + self._parameters[1:, None]) / 2
        half = np.diff(self._parameters)[:, None] / 2
        speeds = self._speed(middle + half * _NODES)
        self._lengths = np.concatenate([[0], np.cumsum((speeds @ _WEIGHTS) * half[:, 0])])
        p = self._parameters
        du, dv = _poly(self._du, p), _poly(self._dv, p)
        ddu, ddv = _poly(self._du[1:] * (1, 2), p), _poly(self._dv[1:] * (1, 2), p)
        speed = np.maximum(np.hypot(du, dv), 1e-9)
        self.bend = float(np.max(np.abs(du * ddv - dv * ddu) / speed**3))
        """The largest curvature, in 1/m."""

    def _speed(self, p: Floats) -> Floats:
        return np.hypot(_poly(self._du, p), _poly(self._dv, p))

    def at(self, ds: Floats) -> tuple[Floats, Floats, Floats]:
        """Local coordinates and turn at arc lengths."""
        p = np.interp(ds, self._lengths, self._parameters)
        for _ in range(2):
            index = np.clip(np.searchsorted(self._parameters, p) - 1, 0, len(self._parameters) - 2)
            start = self._parameters[index]
            half = (p - start)[:, None] / 2
            way = (
                self._lengths[index]
                + (self._speed(start[:, None] + half * (1 + _NODES)) @ _WEIGHTS) * half[:, 0]
            )
            p = np.clip(p + (ds - way) / np.maximum(self._speed(p), 1e-9), 0, self._parameters[-1])
        return _poly(self._u, p), _poly(self._v, p), np.arctan2(_poly(self._dv, p), _poly(self._du, p))


def _poly(coefficients: Floats, p: Floats) -> Floats:
    result = np.zeros_like(p)
    for coefficient in coefficients[::-1]:
        result = result * p + coefficient
    return result


def cubic_values(cubics: Sequence[Cubic], s: Floats, *, before: float = 0.0) -> Floats:
    """Values ``(n,)`` of a piecewise cubic at places ``(n,)``; ``before`` where the first piece has not begun."""
    if not cubics:
        return np.full(len(s), before)
    if len(cubics) == 1:
        only = cubics[0]
        ds = s - only.start
        values = only.a + ds * (only.b + ds * (only.c + ds * only.d))
        return values if only.start <= s[0] else np.where(ds < 0, only.a, values)
    table = np.array([(c.start, c.a, c.b, c.c, c.d) for c in cubics])
    index = np.clip(np.searchsorted(table[:, 0], s, side="right") - 1, 0, None)
    start, a, b, c, d = table[index].T
    ds = np.maximum(s - start, 0)
    return np.asarray(a + ds * (b + ds * (c + ds * d)))


def cubic_bend(cubics: Sequence[Cubic], length: float) -> float:
    """Return the largest second derivative of a piecewise cubic, over pieces that are at most ``length`` long."""
    ends = [*(cubic.start for cubic in cubics[1:]), length + (cubics[0].start if cubics else 0)]
    bends = (
        [
            max(abs(2 * cubic.c), abs(2 * cubic.c + 6 * cubic.d * max(0.0, end - cubic.start)))
            for cubic, end in zip(cubics, ends, strict=True)
        ]
        if cubics
        else [0.0]
    )
    return max(bends)
