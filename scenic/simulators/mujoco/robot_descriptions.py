"""Descriptions of bodies with joints: MJCF and URDF files as MuJoCo reads them.

Bodies that are welded to each other are one *link*. The link that does not move is the base; a free joint at its root is left out.
"""

import math
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.language.errors import Located
from scenic.language.spelling import nearest
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.simulators.mujoco.kinematics import Joint, Segment
from scenic.simulators.mujoco.library import library, quietly

__all__ = ["BASE", "Description", "DescriptionError", "Link", "read_description"]

BASE: Final = "base"
"""The name of the link that does not move."""

Floats = NDArray[np.float64]


class DescriptionError(Located):
    """A description that cannot be used, or a joint, link or frame that it does not have."""

    code = "SC614"


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A rigid part of a description.

    Attributes:
        name: of its outermost body; `BASE` for the one that does not move.
        chain: segments from the base to its frame.
        mesh: what touches others, in its frame, metres; ``None`` if nothing does.
        color: of its first geom, sRGB and opacity.

    """

    name: str
    chain: tuple[Segment, ...]
    mesh: Mesh | None
    color: tuple[float, ...]

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The joints of its chain, from the base outwards."""
        return tuple(joint for segment in self.chain for joint in segment.joints)


@dataclass(frozen=True, slots=True, eq=False)
class Description:
    """A body with joints.

    Attributes:
        path: the file.
        joints: hinges and slides by name, in the file's order.
        links: rigid parts, the base first.
        frames: chains to the frames of bodies and sites, by name.

    """

    path: Path
    joints: Mapping[str, Joint]
    links: tuple[Link, ...]
    frames: Mapping[str, tuple[Segment, ...]]

    def joint(self, name: str) -> Joint:
        """Return a joint; raises `DescriptionError` if there is none of the name."""
        return self._known(self.joints, name, "joint")  # type: ignore[no-any-return] # the mapping is of joints

    def frame(self, name: str) -> tuple[Segment, ...]:
        """Return the chain to a frame; raises `DescriptionError` if there is none of the name."""
        return self._known(self.frames, name, "frame")  # type: ignore[no-any-return] # the mapping is of chains

    def _known(self, table: Mapping[str, object], name: str, kind: str) -> Any:
        if name in table:
            return table[name]
        meant = nearest(str(name), table)
        raise DescriptionError(
            f"'{self.path.name}' has no {kind} {name!r}",
            help=f"did you mean {meant!r}?" if meant else f"its {kind}s are {', '.join(table) or 'none'}",
        )


def read_description(path: str | Path, name: str | None = None) -> Description:
    """Read an MJCF or URDF file, which messages call ``name``; one that has not changed is not read again.

    Raises:
        DescriptionError: the file is missing, broken, or describes nothing that touches.

    """
    file = Path(path).absolute()
    try:
        stamp = file.stat().st_mtime_ns
    except OSError as error:
        raise DescriptionError(
            f"cannot read the description '{name or path}': {(error.strerror or str(error)).lower()}",
            help="give an MJCF (.xml) or URDF (.urdf) file, by its path from the folder of the program",
        ) from error
    return _read(file, stamp)


@lru_cache(maxsize=64)
def _read(path: Path, _stamp: int) -> Description:
    mujoco = library()
    try:
        with quietly():
            spec = mujoco.MjSpec.from_file(str(path))
            for joint in [item for item in spec.joints if item.type == mujoco.mjtJoint.mjJNT_FREE]:
                spec.delete(joint)
            model = spec.compile()
    except ValueError as error:
        raise DescriptionError(
            f"MuJoCo cannot read the description '{path.name}': {' '.join(str(error).split())}",
            help="repair the file; `python -m mujoco.viewer` shows one that is right",
        ) from error
    return _Reader(path, model).description()


class _Reader:
    """Takes a compiled model apart."""

    def __init__(self, path: Path, model: Any) -> None:
        self._path = path
        self._model = model
        self._joints = {number: joint for number in range(model.njnt) if (joint := self._joint(number))}

    def description(self) -> Description:
        model = self._model
        chains = [self._chain(body) for body in range(model.nbody)]
        links = [
            Link(
                BASE if root == 0 else model.body(root).name,
                chains[root],
                self._mesh(root),
                self._color(root),
            )
            for root in range(model.nbody)
            if model.body_weldid[root] == root
        ]
        if all(link.mesh is None for link in links):
            raise DescriptionError(
                f"the description '{self._path.name}' has no body that touches others",
                help="give its bodies geoms (MJCF) or collision elements (URDF)",
            )
        frames = {model.body(body).name or BASE: chains[body] for body in range(1, model.nbody)}
        frames[BASE] = ()
        for site in range(model.nsite):
            x, y, z, w = self._turned(model.site_quat[site])
            site_segment = Segment(tuple(model.site_pos[site].tolist()), (x, y, z, w), ())
            frames[model.site(site).name] = (*chains[model.site_bodyid[site]], site_segment)
        joints = {joint.name: joint for joint in self._joints.values()}
        return Description(self._path, joints, tuple(links), frames)

    def _joint(self, number: int) -> Joint | None:
        """Return a hinge or slide; ball joints stay as they are."""
        model, kinds = self._model, library().mjtJoint
        kind = model.jnt_type[number]
        if kind not in (int(kinds.mjJNT_HINGE), int(kinds.mjJNT_SLIDE)):
            return None
        low, high = model.jnt_range[number].tolist() if model.jnt_limited[number] else (-math.inf, math.inf)
        return Joint(
            model.joint(number).name or f"joint {number}",
            kind == int(kinds.mjJNT_SLIDE),
            tuple(model.jnt_axis[number].tolist()),
            tuple(model.jnt_pos[number].tolist()),
            low,
            high,
            float(model.qpos0[model.jnt_qposadr[number]]),
        )

    def _chain(self, body: int) -> tuple[Segment, ...]:
        """Return the segments from the world to a body."""
        model, segments = self._model, []
        while body:
            first, count = model.body_jntadr[body], model.body_jntnum[body]
            own = [self._joints[number] for number in range(first, first + count) if number in self._joints]
            quaternion = self._turned(model.body_quat[body])
            segments.append(Segment(tuple(model.body_pos[body].tolist()), quaternion, tuple(own)))
            body = int(model.body_parentid[body])
        return tuple(reversed(segments))

    @staticmethod
    def _turned(quaternion: Floats) -> tuple[float, float, float, float]:
        w, x, y, z = (quaternion / np.linalg.norm(quaternion)).tolist()
        return x, y, z, w

    def _geoms(self, root: int) -> list[int]:
        """Return the geoms of a link with which it touches others, planes left out."""
        model, kinds = self._model, library().mjtGeom
        return [
            geom
            for geom in range(model.ngeom)
            if model.body_weldid[model.geom_bodyid[geom]] == root
            and (model.geom_contype[geom] or model.geom_conaffinity[geom])
            and model.geom_type[geom] not in (int(kinds.mjGEOM_PLANE), int(kinds.mjGEOM_HFIELD))
        ]

    def _color(self, root: int) -> tuple[float, ...]:
        geoms = self._geoms(root)
        return tuple(self._model.geom_rgba[geoms[0]].tolist()) if geoms else (0.5, 0.5, 0.5, 1.0)

    def _mesh(self, root: int) -> Mesh | None:
        """Return the union of a link's geoms, in the frame of its outermost body; meshes as their convex hulls, as MuJoCo has them."""
        import trimesh  # slow to import

        model = self._model
        data = library().MjData(model)
        library().mj_kinematics(model, data)
        turn, place = data.xmat[root].reshape(3, 3), data.xpos[root]
        solids = []
        for geom in self._geoms(root):
            solid = self._solid(geom)
            matrix = np.eye(4)
            matrix[:3, :3] = turn.T @ data.geom_xmat[geom].reshape(3, 3)
            matrix[:3, 3] = turn.T @ (data.geom_xpos[geom] - place)
            solids.append(solid.apply_transform(matrix))
        if not solids:
            return None
        whole = trimesh.boolean.union(solids, engine="manifold") if len(solids) > 1 else solids[0]
        return Mesh(np.asarray(whole.vertices, np.float64), np.asarray(whole.faces))

    def _solid(self, geom: int) -> Any:
        import trimesh  # slow to import

        model, kinds = self._model, library().mjtGeom
        kind, size = model.geom_type[geom], model.geom_size[geom]
        if kind == int(kinds.mjGEOM_BOX):
            return trimesh.creation.box(2 * size)
        if kind in (int(kinds.mjGEOM_SPHERE), int(kinds.mjGEOM_ELLIPSOID)):
            scale = size if kind == int(kinds.mjGEOM_ELLIPSOID) else np.full(3, size[0])
            return trimesh.creation.icosphere(subdivisions=2).apply_scale(scale)
        if kind == int(kinds.mjGEOM_CYLINDER):
            return trimesh.creation.cylinder(size[0], 2 * size[1], sections=24)
        if kind == int(kinds.mjGEOM_CAPSULE):
            return trimesh.creation.capsule(2 * size[1], size[0], count=(8, 16)).apply_translation((0, 0, 0))
        number = model.geom_dataid[geom]
        first, count = model.mesh_vertadr[number], model.mesh_vertnum[number]
        points = np.asarray(model.mesh_vert[first : first + count], np.float64)
        return trimesh.convex.convex_hull(points)
