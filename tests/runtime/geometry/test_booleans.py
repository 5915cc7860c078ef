"""Boolean operations on solids: volumes by hand, and where there is no result."""

import numpy as np
import pytest

from scenic.runtime.geometry.meshes import booleans, primitives
from scenic.runtime.geometry.meshes.mesh import Mesh

from .samples import placed

BOX = primitives.box()
BESIDE = placed(BOX, (0.75, 0.25, 0), (1, 1, 0.5))
FAR = placed(BOX, (5, 0, 0), (1, 1, 1))


def test_volumes() -> None:
    common = 0.25 * 0.75 * 0.5
    both, all_of_it = booleans.intersection([BOX, BESIDE]), booleans.union([BOX, BESIDE, FAR])
    rest, other = booleans.difference(BOX, [BESIDE, FAR]), booleans.difference(BESIDE, [BOX])
    assert both is not None and all_of_it is not None and rest is not None and other is not None  # noqa: PT018
    assert both.volume == pytest.approx(common)
    np.testing.assert_allclose(both.bounds, [(0.25, -0.25, -0.25), (0.5, 0.5, 0.25)])
    assert all_of_it.volume == pytest.approx(2.5 - common)
    assert rest.volume == pytest.approx(1 - common)
    assert other.volume == pytest.approx(0.5 - common)


def test_nothing_is_left() -> None:
    assert booleans.intersection([BOX, FAR]) is None
    assert booleans.difference(BOX, [placed(BOX, (0, 0, 0), (2, 2, 2))]) is None


def test_what_is_no_solid_has_no_result_whichever_operand_it_is() -> None:
    holed = Mesh(BOX.vertices, BOX.faces[1:])
    for one, other in ((BESIDE, holed), (holed, BESIDE), (holed, holed)):
        assert booleans.union([one, other]) is None
        assert booleans.intersection([one, other]) is None
        assert booleans.difference(one, [other]) is None
    assert booleans.difference(BOX, [BESIDE, holed]) is None
