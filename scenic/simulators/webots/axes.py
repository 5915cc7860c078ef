"""Axes of Webots worlds, and how places and turns convert between them and ours (x east, y north, z up)."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.language.errors import SimulationCreationError
from scenic.runtime.values.values import Orientation

__all__ = ["Axes", "axis_angle", "orientation_of"]

Floats = NDArray[np.float64]

_DIRECTIONS: Final = {
    "E": (1.0, 0.0, 0.0),
    "N": (0.0, 1.0, 0.0),
    "U": (0.0, 0.0, 1.0),
}


@dataclass(frozen=True)
class Axes:
    """The axes of a world by three letters: where its x, y and z point, such as ``NUE``.

    A turn keeps its meaning for things whose own axes are named alike: with ``NUE``, what is ahead of an object along our y
    is along its x there. Of worlds with left-handed axes (``EUN``) everything is mirrored, turns included.
    """

    name: str = "ENU"

    def __post_init__(self) -> None:
        if sorted(self.name) != ["E", "N", "U"]:
            raise SimulationCreationError(
                f"the world's coordinate system is {self.name!r}",
                help="WorldInfo.coordinateSystem is ENU, NUE or EUN, or three such letters in another order",
            )

    @property
    def matrix(self) -> Floats:
        """The matrix ``(3, 3)`` that takes our vectors to those of the world."""
        return np.array([_DIRECTIONS[letter] for letter in self.name])

    def place(self, ours: Any) -> list[float]:
        """A place or velocity of ours, in the world's axes."""
        found: list[float] = (self.matrix @ np.array(tuple(ours), dtype=np.float64)).tolist()
        return found

    def place_here(self, theirs: Any) -> Floats:
        """A place or velocity of the world, in our axes, ``(3,)``."""
        return self.matrix.T @ np.array(tuple(theirs), dtype=np.float64)

    def spin(self, ours: object) -> list[float]:
        """Return an angular velocity of ours in the world's axes, which turn the other way round where they are left-handed."""
        return [self._hand * value for value in self.place(ours)]

    def spin_here(self, theirs: object) -> Floats:
        """Return an angular velocity of the world, in our axes, ``(3,)``."""
        return self._hand * self.place_here(theirs)

    def turn(self, ours: Orientation) -> Floats:
        """Return the rotation matrix ``(3, 3)`` in the world of an orientation of ours."""
        return self.matrix @ matrix_of(ours) @ self.matrix.T

    def turn_here(self, theirs: Any) -> Orientation:
        """The orientation of nine numbers of a rotation matrix in the world, row by row."""
        turned = np.array(tuple(theirs), dtype=np.float64).reshape(3, 3)
        return orientation_of(self.matrix.T @ turned @ self.matrix)

    @property
    def _hand(self) -> float:
        return float(round(np.linalg.det(self.matrix)))


def matrix_of(turn: Orientation) -> Floats:
    """Return the rotation matrix ``(3, 3)`` of an orientation."""
    from scipy.spatial.transform import Rotation  # slow to import

    return np.asarray(Rotation.from_quat([turn.x, turn.y, turn.z, turn.w]).as_matrix())


def orientation_of(matrix: Floats) -> Orientation:
    """Return the orientation of a rotation matrix ``(3, 3)``."""
    from scipy.spatial.transform import Rotation

    return Orientation.of(tuple(Rotation.from_matrix(matrix).as_quat().tolist()))


def axis_angle(matrix: Floats) -> list[float]:
    """Return a rotation matrix as Webots writes it: the three numbers of an axis of length 1, and an angle in radians."""
    from scipy.spatial.transform import Rotation

    vector = Rotation.from_matrix(matrix).as_rotvec()
    angle = float(np.linalg.norm(vector))
    return [0.0, 0.0, 1.0, 0.0] if angle < 1e-15 else [*(vector / angle).tolist(), angle]
