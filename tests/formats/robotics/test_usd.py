"""OpenUSD, read by its own library."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.formats.robotics.solids import Solid, solids_of
from scenic.formats.robotics.usd import usd, usd_file
from tests.formats.robotics.example import scenes

pytest.importorskip("pxr")

from pxr import Usd, UsdGeom, UsdPhysics, UsdSemantics, UsdShade, UsdValidation


def stage_of(folder: Path, scene: Any, name: str = "scene.usda", *, alone: bool = False) -> Any:
    for path, content in (usd_file if alone else usd)(scene, name).items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_bytes(content)
    return Usd.Stage.Open(str(folder / name))


def box_of(solid: Solid) -> np.ndarray[Any, Any]:
    """The world bounds of the object's own box, as the library bounds prims."""
    from scenic.formats.poses import rotation_matrix

    half = np.abs(rotation_matrix(solid.quaternion)) @ (np.array(solid.size) / 2)
    return np.array([solid.position - half, solid.position + half])


@pytest.mark.parametrize("name", ["scene.usda", "alone.usda", "alone.usdc", "alone.usdz"])
def test_bounds_and_poses_come_back(name: str, tmp_path: Path) -> None:
    for scene in scenes(2):
        folder = tmp_path / str(scene.k)
        folder.mkdir()
        stage = stage_of(folder, scene, name, alone=name.startswith("alone"))
        assert str(stage.GetDefaultPrim().GetPath()) == "/World"
        cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_], False, True)
        poses = UsdGeom.XformCache()
        for solid in solids_of(scene):
            prim = stage.GetPrimAtPath(f"/World/{solid.name}")
            matrix = np.array(poses.GetLocalToWorldTransform(prim))
            assert np.abs(matrix[3, :3] - solid.position).max() < 1e-12
            geometry = stage.GetPrimAtPath(f"/World/{solid.name}/geometry")
            bounds = cache.ComputeWorldBound(geometry).ComputeAlignedRange()
            assert np.abs(np.array([bounds.GetMin(), bounds.GetMax()]) - box_of(solid)).max() < 1e-6


def test_the_library_finds_no_fault(tmp_path: Path) -> None:
    stage = stage_of(tmp_path, scenes(1)[0])
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    assert [error.GetMessage() for error in context.Validate(stage)] == []


def test_physics_labels_and_cameras(tmp_path: Path) -> None:
    scene = scenes(1)[0]
    stage = stage_of(tmp_path, scene)
    assert stage.GetRootLayer().customLayerData["scenic"]["k"] == scene.k

    def prim(path: str) -> Any:
        return stage.GetPrimAtPath(f"/World/{path}")

    assert not prim("table").HasAPI(UsdPhysics.RigidBodyAPI)
    assert UsdPhysics.MassAPI(prim("cone")).GetMassAttr().Get() == 2
    assert not prim("ghost/geometry").HasAPI(UsdPhysics.CollisionAPI)
    for name, corners in (("can", 24), ("cone", 32)):
        touching = prim(f"{name}/collision")
        assert touching.HasAPI(UsdPhysics.CollisionAPI)
        assert not prim(f"{name}/geometry").HasAPI(UsdPhysics.CollisionAPI)
        assert UsdGeom.Imageable(touching).ComputePurpose() == UsdGeom.Tokens.guide
        assert touching.GetAttribute("radius").Get() == pytest.approx(0.05 * np.cos(np.pi / corners))
    labels = UsdSemantics.LabelsAPI(prim("can"), "class").GetLabelsAttr().Get()
    assert list(labels) == ["drink"]
    assert prim("part/geometry").IsInstance()
    part = next(solid for solid in solids_of(scene) if solid.name == "part")
    assert prim("part").GetCustomDataByKey("scenic")["width"] == part.size[0]
    friction, _ = UsdShade.MaterialBindingAPI(prim("table/geometry")).ComputeBoundMaterial("physics")
    assert UsdPhysics.MaterialAPI(friction).GetStaticFrictionAttr().Get() == pytest.approx(0.8)
    eye = UsdGeom.Camera(prim("ego/eye")).GetCamera(Usd.TimeCode.Default())
    assert eye.GetFieldOfView(eye.FOVHorizontal) == pytest.approx(60, abs=1e-3)
    # It looks along the ego's front.
    ahead = np.array(eye.frustum.ComputeViewDirection())
    turn = next(thing for thing in scene.objects if thing is scene.egoObject).orientation
    front = np.array([2 * (turn.x * turn.y - turn.z * turn.w), 1 - 2 * (turn.x**2 + turn.z**2),
                      2 * (turn.y * turn.z + turn.x * turn.w)])  # fmt: skip
    assert np.abs(ahead - front).max() < 1e-6


def test_an_image_becomes_the_colour_of_its_object(tmp_path: Path) -> None:
    from PIL import Image

    Image.new("RGB", (4, 4), (200, 30, 10)).save(tmp_path / "wood.png")
    scenario = scenic.scenarioFromString(
        "ego = new Object with texture {'image': 'wood.png', 'scale': 1}, with shape ConeShape(), with length 2\n"
        "big = new Object at (9, 0), with texture {'image': 'wood.png', 'scale': 1}, with shape ConeShape(), with length 4\n",
        filename=str(tmp_path / "a.scenic"),
    )
    stage = stage_of(tmp_path, next(iter(scenario.sample(1, seed=1))))
    # The image covers a metre, so that the meshes of the two sizes cannot be one.
    repeats = [
        np.ptp(
            UsdGeom.PrimvarsAPI(stage.GetPrimAtPath(f"/World/{name}/geometry/mesh")).GetPrimvar("st").Get(),
            axis=0,
        )
        for name in ("ego", "big")
    ]
    assert (repeats[1] > 1.5 * repeats[0]).any()
    material, _ = UsdShade.MaterialBindingAPI(
        stage.GetPrimAtPath("/World/ego/geometry")
    ).ComputeBoundMaterial()
    image = UsdShade.Shader(stage.GetPrimAtPath(f"{material.GetPath()}/image"))
    file = image.GetInput("file").Get()
    assert Path(file.resolvedPath).read_bytes() == (tmp_path / "wood.png").read_bytes()
