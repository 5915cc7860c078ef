"""Bodies over lanes: which mesh, where, how large."""

from collections.abc import Iterator
from dataclasses import field, replace

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Indices, Poses


@dataclass(frozen=True, eq=False)
class Body:
    """One object over the lanes, as a column: a table of meshes, a mesh number for each lane, and poses.

    Every part has one row for each lane, or a single row where it is the same in all of them.

    Attributes:
        meshes: the unit meshes it may have.
        choice: which of them it has in each lane, ``(n,)`` or ``(1,)``; ``None`` if there is only one.
        poses: where it is. Rotation matrices and world boxes are computed once and go along with `take`.
        allow: whether it may collide, ``(n,)`` or ``(1,)``.
        is_fixed: whether all of this is known to be the same in every batch: a fact about the program, never read
            off the number of rows, since a batch may come down to a single lane.

    """

    meshes: tuple[Mesh, ...]
    choice: Indices | None
    poses: Poses
    allow: Booleans = field(default_factory=lambda: np.zeros(1, dtype=np.bool_))
    is_fixed: bool = False

    def __post_init__(self) -> None:
        if self.is_fixed and len(self) != 1:
            raise ValueError(f"a fixed body with {len(self)} rows")

    def __len__(self) -> int:
        """The number of lanes; 1 also where it is the same in all of them."""
        lengths = {len(self.poses), len(self.allow), 1 if self.choice is None else len(self.choice)} - {1}
        return lengths.pop() if lengths else 1

    def take(self, lanes: Indices) -> "Body":
        """Return the body in these lanes; parts that are the same everywhere stay so."""
        choice = self.choice
        return replace(
            self,
            choice=choice if choice is None or len(choice) == 1 else choice[lanes],
            poses=self.poses.take(lanes),
            allow=self.allow if len(self.allow) == 1 else self.allow[lanes],
        )

    def by_mesh(self, lanes: int) -> Iterator[tuple[Mesh, Indices]]:
        """Yield the meshes with the lanes ``(m,)`` in which the body has them, out of ``lanes``."""
        if self.choice is None or len(self.choice) == 1:
            number = 0 if self.choice is None else int(self.choice[0])
            yield self.meshes[number], np.arange(lanes)
            return
        for number, mesh in enumerate(self.meshes):
            chosen = np.flatnonzero(self.choice == number)
            if len(chosen):
                yield mesh, chosen
