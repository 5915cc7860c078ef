"""Colours of cars over lanes are those of the formula of one."""

import random

from scenic.simulators.utils.colors import _SHIFTED, Color


def test_colours_together_are_those_one_by_one() -> None:
    chance = random.Random(1)
    bases = [Color(*(chance.randint(0, 255) / 255 for _ in range(3))) for _ in range(40)]
    bases += [Color(0.0, 0.0, 0.0), Color(1.0, 1.0, 1.0), Color(0.5, 0.5, 0.5), Color(1.0, 0.0, 0.0)]
    rows = [(chance.choice(bases), *(chance.gauss(0, 0.4) for _ in range(3))) for _ in range(2000)]
    assert _SHIFTED.python is not None
    assert _SHIFTED.together is not None
    together = _SHIFTED.together(*map(list, zip(*rows, strict=True)))
    assert together == [_SHIFTED.python(*row) for row in rows]


def test_what_is_no_colour_is_left_to_the_formula_of_one() -> None:
    assert _SHIFTED.together is not None
    assert _SHIFTED.together([(1, 2)], [0.0], [0.0], [0.0]) is None
    assert _SHIFTED.together([[1.0, 0.0, 0.0]], [0.0], [0.0], [0.0]) is None
