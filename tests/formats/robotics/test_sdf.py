"""SDFormat and URDF: as text, and read by Drake and PyBullet where these are installed."""

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from scenic.formats.robotics.sdf import sdf
from scenic.formats.robotics.solids import solids_of
from tests.formats.robotics.example import scenes


def written(folder: Path, scene: object) -> Path:
    for name, content in sdf(scene, "scene.sdf").items():  # type: ignore[arg-type]
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
    return folder / "scene.sdf"


def test_models_have_the_objects_poses_masses_and_files(tmp_path: Path) -> None:
    scene = scenes(1)[0]
    world = ET.parse(written(tmp_path, scene)).getroot().find("world")
    assert world is not None
    models = {model.get("name"): model for model in world.findall("model")}
    for solid in solids_of(scene):
        model = models[solid.name]
        pose = [float(number) for number in (model.findtext("pose") or "").split()]
        assert pose == [*solid.position, *solid.quaternion]
        assert float(model.findtext("link/inertial/mass") or 0) == solid.inertia.mass
        assert (model.findtext("static") == "true") == solid.is_static
        assert (model.find("link/collision") is None) == (not solid.collides)
    shown, touching = (
        float(models["can"].findtext(f"link/{part}/geometry/cylinder/radius") or 0)
        for part in ("visual", "collision")
    )
    assert (shown, touching) == pytest.approx((0.05, 0.05 * np.cos(np.pi / 24)))
    for uri in world.iter("uri"):
        assert (tmp_path / (uri.text or "")).is_file()


def test_drake_reads_the_world_and_finds_no_penetration(tmp_path: Path) -> None:
    drake = pytest.importorskip("pydrake.all")
    for scene in scenes(2):
        builder = drake.DiagramBuilder()
        plant, graph = drake.AddMultibodyPlantSceneGraph(builder, 0.001)
        drake.Parser(plant).AddModels(str(written(tmp_path, scene)))
        plant.Finalize()
        diagram = builder.Build()
        context = diagram.CreateDefaultContext()
        mine = plant.GetMyContextFromRoot(context)
        for solid in solids_of(scene):
            body = plant.GetBodyByName("link", plant.GetModelInstanceByName(solid.name))
            place = plant.EvalBodyPoseInWorld(mine, body)
            assert np.abs(place.translation() - solid.position).max() < 1e-5
            assert abs(abs(place.rotation().ToQuaternion().xyz() @ np.array(solid.quaternion[:3])
                           + place.rotation().ToQuaternion().w() * solid.quaternion[3]) - 1) < 1e-9  # fmt: skip
            if not solid.is_static:
                assert body.default_mass() == pytest.approx(solid.inertia.mass)
        query = graph.get_query_output_port().Eval(graph.GetMyContextFromRoot(context))
        assert all(pair.depth < 1e-4 for pair in query.ComputePointPairPenetration())


def test_pybullet_reads_every_urdf(tmp_path: Path) -> None:
    bullet = pytest.importorskip("pybullet")
    scene = scenes(1)[0]
    written(tmp_path, scene)
    client = bullet.connect(bullet.DIRECT)
    try:
        masses = {solid.name: solid.inertia.mass for solid in solids_of(scene)}
        for entry in json.loads((tmp_path / "scene.json").read_text())["objects"]:
            body = bullet.loadURDF(
                str(tmp_path / entry["urdf"]),
                entry["position"],
                entry["quaternion"],
                useFixedBase=entry["static"],
            )
            if not entry["static"]:
                assert bullet.getDynamicsInfo(body, -1)[0] == pytest.approx(masses[entry["name"]])
    finally:
        bullet.disconnect(client)
