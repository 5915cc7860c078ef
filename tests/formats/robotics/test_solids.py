"""Facts of physics about objects."""

import numpy as np
import pytest
import trimesh

import scenic
from scenic.formats.robotics.solids import SolidError, identifiers, solids_of
from tests.formats.robotics.example import scenes


def test_mass_properties_are_those_of_the_mesh() -> None:
    for solid in solids_of(scenes(1)[0]):
        mesh = trimesh.Trimesh(solid.mesh.vertices * solid.size, solid.mesh.faces, process=False)
        mesh.density = solid.inertia.mass / mesh.volume
        assert np.allclose(solid.inertia.center, mesh.center_mass, atol=1e-12)
        assert np.allclose(solid.inertia.matrix, mesh.moment_inertia, rtol=1e-9, atol=1e-12)


def test_forms_are_exact_or_meshes() -> None:
    forms = {solid.name: solid.form for solid in solids_of(scenes(1)[0])}
    assert forms == {
        "ego": "box", "table": "box", "ball": "sphere", "can": "cylinder", "cone": "cone", "part": "mesh", "egg": "ellipsoid", "ghost": "box",
    }  # fmt: skip


def test_names_are_identifiers_and_distinct() -> None:
    assert identifiers(iter(["a b", "a_b", "7up", "ü", "a b"])) == ["a_b", "a_b_2", "_7up", "_", "a_b_3"]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("mass -1", "mass of .* must be a positive number, not -1"),
        ("density 'wood'", "density of .* must be a positive number, not 'wood'"),
        ("friction -0.5", "friction of .* from 0 to 100, not -0.5"),
        ("restitution 2", "restitution of .* from 0 to 1, not 2"),
    ],
)
def test_impossible_values_are_refused_at_the_object(given: str, message: str) -> None:
    scenario = scenic.scenarioFromString(f"ego = new Object\nx = new Object at (5, 5), with {given}\n")
    with pytest.raises(SolidError, match=message) as caught:
        solids_of(next(iter(scenario.sample(1, seed=1))))
    assert caught.value.span is not None
    assert caught.value.span.line == 2
