"""Files of robot simulators, read back by their own libraries: ``python -m benchmarks.round_trips [trips | contacts]``; both by default.

``trips``: a scene of every example and of 200 random typed programs, written as OpenUSD, MJCF and SDFormat. Poses, bounds and masses are compared, and
the validators of the formats must be silent. ``contacts``: scenes of five programs in which MuJoCo and Drake look for things that
enter each other by more than 1e-4 m, an independent test of collisions. Formats whose library is not installed are left out.
"""

import argparse
import importlib.util
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np

import scenic
from benchmarks.drake_worlds import Worlds
from fuzz.semantics.programs import texts
from scenic.formats.poses import rotation_matrix
from scenic.formats.robotics.scene_files import scene_files
from scenic.formats.robotics.solids import Solid, solids_of
from scenic.language.errors import Located, ScenicError
from scenic.runtime.sampling.rejection_report import Exhausted

EXAMPLES = Path(__file__).parents[1] / "examples"
FIVE = (
    "tabletop/set_table",
    "tabletop/stacked_blocks",
    "indoor/bookshelf",
    "indoor/furnished_room",
    "arm/tidy",
)
TOLERANCE: Final[Mapping[str, float]] = {"usd": 1e-6, "mjcf": 1e-6, "sdf": 1e-5}
DEEP = 1e-4
ATTEMPTS = 3000


def bounds(vertices: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    return np.array([vertices.min(axis=0), vertices.max(axis=0)])


def outer_bounds(solid: Solid) -> np.ndarray[Any, Any]:
    """World bounds of the object's own box, as OpenUSD bounds prims."""
    half = np.abs(rotation_matrix(solid.quaternion)) @ (np.array(solid.size) / 2)
    return np.array([solid.position - half, solid.position + half])


def mesh_bounds(solid: Solid) -> np.ndarray[Any, Any]:
    """World bounds of the object's mesh."""
    return bounds((solid.mesh.vertices * solid.size) @ rotation_matrix(solid.quaternion).T + solid.position)


class Reader:
    """The deviations of what a library reads from a scene's file, relative to the size of what is compared where that exceeds 1."""

    def __init__(self, form: str, path: Path, solids: tuple[Solid, ...], worlds: Worlds) -> None:
        self._worlds = worlds
        self.worst: dict[str, float] = {"pose": 0.0, "bounds": 0.0, "mass": 0.0}
        self.faults: list[str] = []
        getattr(self, f"_{form}")(path, solids)

    def _note(self, kind: str, ours: object, theirs: object) -> None:
        mine, other = np.asarray(ours, np.float64), np.asarray(theirs, np.float64)
        difference = float((np.abs(mine - other) / np.maximum(1.0, np.abs(mine))).max())
        self.worst[kind] = max(self.worst[kind], difference)

    def _turn(self, solid: Solid, matrix: np.ndarray[Any, Any]) -> None:
        self._note("pose", rotation_matrix(solid.quaternion), matrix)

    def _usd(self, path: Path, solids: tuple[Solid, ...]) -> None:
        from pxr import Usd, UsdGeom, UsdPhysics, UsdValidation

        stage = Usd.Stage.Open(str(path))
        cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_], False, True)
        poses = UsdGeom.XformCache()
        prims = {
            prim.GetCustomDataByKey("scenic:index"): prim for prim in stage.GetDefaultPrim().GetChildren()
        }
        for solid in solids:
            prim = prims[solid.index]
            matrix = np.array(poses.GetLocalToWorldTransform(prim))
            self._note("pose", solid.position, matrix[3, :3])
            self._turn(solid, matrix[:3, :3].T)
            box = cache.ComputeWorldBound(
                stage.GetPrimAtPath(f"{prim.GetPath()}/geometry")
            ).ComputeAlignedRange()
            if solid.is_rendered:  # bounds of what is invisible are empty
                self._note("bounds", outer_bounds(solid), [box.GetMin(), box.GetMax()])
            if not solid.is_static:
                self._note("mass", 1.0, UsdPhysics.MassAPI(prim).GetMassAttr().Get() / solid.inertia.mass)
        context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
        self.faults += [error.GetMessage() for error in context.Validate(stage)]

    def _mjcf(self, path: Path, solids: tuple[Solid, ...]) -> None:
        import mujoco

        model = mujoco.MjModel.from_xml_path(str(path))
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        for solid in solids:
            body = data.body(solid.name)
            self._note("pose", solid.position, body.xpos)
            self._turn(solid, body.xmat.reshape(3, 3))
            geom = model.geom(solid.name)
            if geom.type[0] == int(mujoco.mjtGeom.mjGEOM_MESH):
                first, count = model.mesh_vertadr[geom.dataid[0]], model.mesh_vertnum[geom.dataid[0]]
                points = model.mesh_vert[first : first + count].astype(np.float64)
                turn = data.geom(solid.name).xmat.reshape(3, 3)
                self._note("bounds", mesh_bounds(solid), bounds(points @ turn.T + data.geom(solid.name).xpos))
            elif geom.type[0] in (int(mujoco.mjtGeom.mjGEOM_BOX), int(mujoco.mjtGeom.mjGEOM_ELLIPSOID)):
                self._note("bounds", np.array(solid.size) / 2, geom.size)
            if not solid.is_static:
                self._note("mass", 1.0, model.body(solid.name).mass[0] / solid.inertia.mass)
        mujoco.mj_step(model, data)
        self.faults += [f"warning {number}" for number, item in enumerate(data.warning) if item.number]

    def _sdf(self, path: Path, solids: tuple[Solid, ...]) -> None:
        models = self._worlds.read(path)["models"]
        for solid in solids:
            model = models[solid.name]
            self._note("pose", solid.position, model["position"])
            self._turn(solid, np.array(model["matrix"]))
            if not solid.is_static:
                self._note("mass", 1.0, model["mass"] / solid.inertia.mass)
            if "size" in model:
                self._note("bounds", solid.size, model["size"])
            if "hull" in model:
                self._note("bounds", mesh_bounds(solid), bounds(np.array(model["hull"])))


def forms() -> list[str]:
    """The formats whose libraries are installed."""
    libraries = {"usd": "pxr", "mjcf": "mujoco", "sdf": "pydrake"}
    there = [form for form, library in libraries.items() if importlib.util.find_spec(library)]
    for form in libraries.keys() - there:
        print(f"{form} is left out: {libraries[form]} is not installed")
    return there


def write(scene: Any, form: str, folder: Path) -> Path:
    """Write a scene as in a data set; the path of its own file."""
    files = scene_files(scene, form, "scene")
    for name, content in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(content)
    return folder / next(iter(files))


def first_scene(load: Callable[[], scenic.Scenario]) -> Any:
    """A scene of a program; ``None`` where there is none that can be found soon."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            (scene,) = load().stream(1, seed=1, max_attempts=ATTEMPTS)
        except ScenicError:
            return None
    return None if isinstance(scene, Exhausted) else scene


def sources(count: int) -> Iterator[tuple[str, Any]]:
    """Scenes with their names: of all examples, then of ``count`` random programs that have scenes."""
    for path in sorted(EXAMPLES.rglob("*.scenic")):
        yield str(path.relative_to(EXAMPLES)), first_scene(lambda path=path: scenic.load(path))  # type: ignore[misc]
    left, number = count, 0
    while left:
        number += 1
        for index, text in enumerate(texts(100, number)):
            scene = first_scene(lambda text=text: scenic.scenarioFromString(text))  # type: ignore[misc]
            if scene is not None and left:
                left -= 1
                yield f"random {number}.{index}", scene


def trips(count: int, worlds: Worlds) -> None:
    """Print the worst deviations of every format."""
    worst: dict[str, Counter[str]] = {form: Counter() for form in forms()}
    made, failures, missing = 0, 0, []
    start_time = time.monotonic()
    for name, scene in sources(count):
        if scene is None:
            missing.append(name)
            continue
        made += 1
        solids = solids_of(scene)
        for form, table in worst.items():
            with TemporaryDirectory() as folder:
                try:
                    read = Reader(form, write(scene, form, Path(folder)), solids, worlds)
                except (Located, Exception) as error:  # noqa: BLE001 - it is what is looked for
                    failures += 1
                    place = traceback.extract_tb(error.__traceback__)[-1]
                    print(
                        f"{name}: {form}: {type(error).__name__}: {str(error)[:300]} ({place.filename}:{place.lineno})"
                    )
                    continue
            for fault in read.faults:
                failures += 1
                print(f"{name}: {form}: {fault[:300]}")
            for kind, value in read.worst.items():
                if value > table[kind]:
                    table[kind] = value  # type: ignore[assignment] # of numbers, not counts
                if value > TOLERANCE[form]:
                    failures += 1
                    print(f"{name}: {form}: {kind} differ by {value:.2e}")
    print(
        f"{made} programs in {time.monotonic() - start_time:.0f} s, {failures} failures; without a scene: {', '.join(missing) or 'none'}"
    )
    for form, table in worst.items():
        print(f"    {form}: " + ", ".join(f"{kind} {table[kind]:.1e}" for kind in ("pose", "bounds", "mass")))


def depths(scene: Any, form: str, worlds: Worlds) -> list[tuple[float, str]]:
    """The depths by which pairs of things enter each other, metres, with their names."""
    with TemporaryDirectory() as folder:
        path = write(scene, form, Path(folder))
        if form == "mjcf":
            import mujoco

            model = mujoco.MjModel.from_xml_path(str(path))
            data = mujoco.MjData(model)
            mujoco.mj_forward(model, data)
            return [
                (-float(contact.dist), " and ".join(model.geom(int(geom)).name for geom in contact.geom))
                for contact in data.contact
            ]
        return [(depth, f"{one} and {other}") for depth, one, other in worlds.read(path)["pairs"]]


def contacts(count: int, worlds: Worlds, chosen: tuple[str, ...]) -> None:
    """Print, program by program, in how many scenes something enters something else."""
    for name in chosen:
        scenario = scenic.load(EXAMPLES / f"{name}.scenic")
        deep = {form: 0 for form in forms() if form != "usd"}
        deepest = (0.0, "")
        start_time = time.monotonic()
        for scene in scenario.sample(count, seed=1):
            for form in deep:
                worst = max(depths(scene, form, worlds), default=(0.0, ""))
                deep[form] += worst[0] > DEEP
                deepest = max(deepest, worst)
        print(
            f"{name:24} {count} scenes, deeper than {DEEP:g} m: "
            + ", ".join(f"{form} {number}" for form, number in deep.items())
            + f"; the deepest {deepest[0]:.1e} m ({deepest[1]}), {time.monotonic() - start_time:.0f} s",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", nargs="?", choices=("trips", "contacts"))
    parser.add_argument(
        "-n",
        type=int,
        default=200,
        help="random programs, and scenes of each of the five programs (default 200)",
    )
    parser.add_argument("--program", action="append", help="only this example, for `contacts`; repeatable")
    options = parser.parse_args()
    with Worlds() as worlds:
        if options.part != "contacts":
            trips(options.n, worlds)
        if options.part != "trips":
            contacts(options.n, worlds, tuple(options.program or FIVE))


if __name__ == "__main__":
    main()
