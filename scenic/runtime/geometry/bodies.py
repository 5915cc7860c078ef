"""Bodies over lanes, and walking over the meshes that they may have."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from scenic.runtime.geometry.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Indices, Poses


def _never() -> Booleans:
    return np.zeros(1, dtype=np.bool_)


@dataclass(frozen=True)
class Body:
    """One object over the lanes.

    Attributes:
        meshes: the unit meshes it may have.
        choice: which of them it has in each lane, ``(n,)`` or ``(1,)``; ``None`` if there is only one.
        poses: where it is.
        allow: whether it may collide, ``(n,)`` or ``(1,)``.

    """

    meshes: tuple[Mesh, ...]
    choice: Indices | None
    poses: Poses
    allow: Booleans = field(default_factory=_never)

    @property
    def lanes(self) -> int:
        """The number of lanes; 1 where it is the same in all of them."""
        lengths = {len(self.poses), len(self.allow), 1 if self.choice is None else len(self.choice)} - {1}
        return lengths.pop() if lengths else 1

    @property
    def is_fixed(self) -> bool:
        """Whether it is the same in all lanes."""
        return self.lanes == 1

    def by_mesh(self, lanes: int) -> Iterator[tuple[Mesh, Indices]]:
        """The meshes with the lanes ``(m,)`` in which the body has them, out of ``lanes``."""
        if self.choice is None or len(self.choice) == 1:
            number = 0 if self.choice is None else int(self.choice[0])
            yield self.meshes[number], np.arange(lanes)
            return
        for number, mesh in enumerate(self.meshes):
            chosen = np.flatnonzero(self.choice == number)
            if len(chosen):
                yield mesh, chosen
