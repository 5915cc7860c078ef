"""MJCF, read by MuJoCo."""

from pathlib import Path

import numpy as np
import pytest

import scenic
from scenic.formats.robotics.mjcf import mjcf
from scenic.formats.robotics.solids import solids_of
from scenic.simulators.mujoco import MujocoSimulator
from tests.formats.robotics.example import scenes

mujoco = pytest.importorskip("mujoco")


def written(folder: Path, scene: object, *, inline: bool) -> Path:
    for name, content in mjcf(scene, "scene.xml", inline=inline).items():  # type: ignore[arg-type]
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
    return folder / "scene.xml"


@pytest.mark.parametrize("inline", [True, False])
def test_poses_and_masses_come_back(inline: bool, tmp_path: Path) -> None:
    for scene in scenes():
        model = mujoco.MjModel.from_xml_path(str(written(tmp_path, scene, inline=inline)))
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        for solid in solids_of(scene):
            x, y, z, w = solid.quaternion
            body = data.body(solid.name)
            assert np.abs(body.xpos - solid.position).max() < 1e-12
            assert abs(abs(body.xquat @ np.array([w, x, y, z])) - 1) < 1e-12
            if not solid.is_static:
                assert model.body(solid.name).mass[0] == pytest.approx(solid.inertia.mass, rel=1e-9)
        assert data.ncon == 0 or data.contact.dist.min() > -1e-4
        mujoco.mj_resetDataKeyframe(model, data, 0)
        assert np.abs(data.qpos - model.qpos0).max() < 1e-12
        camera = data.camera("ego eye")
        assert np.abs(camera.xpos - data.body("ego").xpos).max() < 0.1


def test_the_model_is_that_of_the_simulator(tmp_path: Path) -> None:
    scene = scenes(1)[0]
    model = mujoco.MjModel.from_xml_path(str(written(tmp_path, scene, inline=True)))
    other = MujocoSimulator().simulate(scene, maxSteps=1).model
    assert model.ngeom == other.ngeom
    assert model.nq == other.nq
    mine = {model.body(k).name: k for k in range(model.nbody)}
    for solid, number in zip(solids_of(scene), range(1, other.nbody), strict=True):
        body = mine[solid.name]
        assert model.body_pos[body] == pytest.approx(other.body_pos[number], abs=1e-9)
        # The mesh of a cone is exact there, too; spheres, ellipsoids and cylinders have the mass of the round form there.
        if solid.form in ("box", "mesh", "cone") and not solid.is_static:
            assert model.body_mass[body] == pytest.approx(other.body_mass[number], rel=1e-5)
            assert model.body_inertia[body] == pytest.approx(other.body_inertia[number], rel=1e-4)
    for name in ("timestep", "integrator", "cone", "impratio"):
        assert getattr(model.opt, name) == getattr(other.opt, name)


def test_steps_give_no_warning(tmp_path: Path) -> None:
    model = mujoco.MjModel.from_xml_path(str(written(tmp_path, scenes(1)[0], inline=False)))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 100)
    egg = data.body("egg").xmat.copy()
    mujoco.mj_step(model, data, 900)
    assert not any(warning.number for warning in data.warning)
    assert np.isfinite(data.qpos).all()
    assert np.abs(data.body("egg").xmat - egg).max() < 0.01  # as it was put down, it stays


def test_an_object_may_be_called_ground(tmp_path: Path) -> None:
    scenario = scenic.scenarioFromString(
        "ground = new Object with dynamics 'static'\nego = new Object at (0, 3)\n"
    )
    (scene,) = scenario.sample(1, seed=1)
    model = mujoco.MjModel.from_xml_path(str(written(tmp_path, scene, inline=True)))
    assert {model.body(number).name for number in range(model.nbody)} == {"world", "ground", "ego"}


def test_cylinders_that_do_not_collide_do_not_touch(tmp_path: Path) -> None:
    """Sides of our prisms that face each other are nearer than round cylinders of their width could be."""
    scenario = scenic.scenarioFromString(
        "for x in (0, 0.992):\n    new Object at (x, 0, 5), with shape CylinderShape(), facing 7.5 deg\n"
    )
    (scene,) = scenario.sample(1, seed=1)
    model = mujoco.MjModel.from_xml_path(str(written(tmp_path, scene, inline=True)))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.ncon == 0
    assert sorted(model.geom_size[1:, 0]) == pytest.approx([0.5 * np.cos(np.pi / 24)] * 2 + [0.5] * 2)
    assert model.body_mass[1] == pytest.approx(solids_of(scene)[0].inertia.mass)
    simulated = MujocoSimulator(gravity=0).simulate(scene, maxSteps=2)
    assert np.abs(np.subtract(simulated.trajectory[0], simulated.trajectory[-1])).max() == 0
