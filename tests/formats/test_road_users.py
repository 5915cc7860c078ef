"""The bodies that pictures show of vehicles and pedestrians in place of their boxes."""

import json
import struct
from collections import Counter

import numpy as np
import pytest

import scenic
from scenic.formats.appearance_names import NAMES
from scenic.formats.glb import glb
from scenic.formats.html import Page
from scenic.formats.mesh_instances import Gallery, picture, resting
from scenic.formats.obj import obj
from scenic.formats.painted_solids import Modeller
from scenic.formats.render import render
from scenic.formats.road_users import APPEARANCES, AppearanceError, appearance_of

RED = "with color (1, 0, 0)"


def scene(*things: str, mode2d: bool = False):
    lines = [
        f"new Object at ({20 * number}, 0, 0), with requireVisible False, {thing}"
        for number, thing in enumerate(things)
    ]
    return scenic.scenarioFromString("\n".join(lines) + "\n", mode2D=mode2d).generate(seed=1)[0]


def volume(model: Modeller) -> float:
    """The volume that a mesh encloses, by the divergence theorem; every edge must join two faces in opposite directions."""
    made = model.appearance()
    edges = Counter(
        (int(a), int(b)) for face in made.faces for a, b in zip(face, np.roll(face, -1), strict=True)
    )
    assert all(edges[b, a] == count for (a, b), count in edges.items())
    a, b, c = (made.vertices[made.faces[:, corner]] * made.size for corner in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def test_solids_are_closed_and_enclose_their_volume() -> None:
    model = Modeller()
    model.box((0, 0, 0), (1, 2, 3))
    assert volume(model) == pytest.approx(6)
    model = Modeller()
    model.tube((1, 1, 1), (1, 3, 1), 0.5, sides=200)
    assert volume(model) == pytest.approx(np.pi / 2, rel=1e-3)
    model = Modeller()
    model.tube((0, 0, 0), (1, 1, 3), 1, end_radius=0.5, sides=200)
    assert volume(model) == pytest.approx(np.pi * np.sqrt(11) / 3 * (1 + 0.5 + 0.25), rel=1e-3)
    model = Modeller()
    model.ball((3, 2, 1), (1, 2, 3), sides=100)
    assert volume(model) == pytest.approx(8 * np.pi, rel=1e-2)
    model = Modeller()
    model.hoop((0, 1, 0), 2, 0.1, sides=200)
    assert volume(model) == pytest.approx(0.1 * 0.1 * 4 * np.pi, rel=1e-3)


def test_every_name_has_an_appearance() -> None:
    assert tuple(APPEARANCES) == NAMES


@pytest.mark.parametrize("name", APPEARANCES)
def test_an_appearance_fills_the_box_of_its_object(name: str) -> None:
    made = appearance_of(scene(f"with appearance '{name}'").objects[0])
    assert made is not None
    assert made.vertices.min(axis=0) == pytest.approx([-0.5] * 3)
    assert made.vertices.max(axis=0) == pytest.approx([0.5] * 3)
    assert np.isnan(made.paints[:, 0]).any(), "some of it has the object's colour"
    assert len(made.faces) < 1500
    a, b, c = (made.vertices[made.faces[:, corner]] * made.size for corner in range(3))
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 1e-7


def test_pictures_show_the_object_s_colour_and_others() -> None:
    drawn = picture([scene(f"with appearance 'bus', with width 2.5, with length 11, with height 3.1, {RED}")])
    image = render(drawn, 0, (160, 120)).reshape(-1, 3).astype(int)
    red = (image[:, 0] > 150) & (image[:, 1] < 60)
    glass = (image.max(axis=1) < 60) & (image[:, 2] > image[:, 0])
    assert red.sum() > 500
    assert glass.sum() > 200


def test_a_shape_that_the_program_gives_is_shown() -> None:
    shown = scene(
        "with appearance 'car', with shape SpheroidShape()", "with appearance None", "with shape BoxShape()"
    )
    assert [appearance_of(thing) for thing in shown.objects] == [None, None, None]


def test_an_unknown_appearance_is_reported_at_the_object() -> None:
    wrong = scene("with width 1", "with appearance 'lorry'")
    with pytest.raises(AppearanceError, match="there is no appearance 'lorry'") as caught:
        Gallery().add(wrong)
    assert caught.value.code == "SC616"
    assert caught.value.line == 2


def test_objects_of_one_appearance_share_a_surface() -> None:
    gallery = Gallery()
    instances = gallery.add(scene("with appearance 'car'", "with appearance 'car'", "with appearance 'bus'"))
    assert [item.surface for item in instances] == [0, 0, 1]


def test_files_have_the_colours() -> None:
    car = scene(f"with appearance 'car', {RED}")
    content = glb(car)
    (length,) = struct.unpack_from("<I", content, 12)
    document = json.loads(content[20 : 20 + length])
    (mesh,) = document["meshes"]
    colors = [
        tuple(document["materials"][part["material"]]["pbrMetallicRoughness"]["baseColorFactor"])
        for part in mesh["primitives"]
    ]
    assert (1.0, 0.0, 0.0, 1.0) in colors
    assert len(set(colors)) == len(colors) > 3
    faces = sum(document["accessors"][part["indices"]]["count"] for part in mesh["primitives"]) // 3
    text, library = (part.decode() for part in obj(car, "car.mtl"))
    assert text.count("\nf ") == faces
    assert text.count("usemtl") == library.count("newmtl") == len(colors)
    assert "Kd 1 0 0" in library


def test_pages_have_the_colours_of_corners() -> None:
    page = Page("page")
    page.add(scene("with appearance 'bicycle'", "with width 1"))
    bicycle, box = page.data()["meshes"]
    assert "paints" in bicycle
    assert "paints" not in box


def test_on_maps_what_has_the_height_of_the_mode_is_as_high_as_it_looks() -> None:
    people = Gallery().add(
        scene(
            "with appearance 'pedestrian', with width 0.75, with length 0.75",
            "with appearance 'bus', with width 2.5, with length 11, with height 3.1",
            "with width 2, with length 4.5",
            mode2d=True,
        )
    )
    heights = [item.size[2] for item in resting(people)]
    assert heights == pytest.approx([1.76, 3.1, 1.5], abs=0.03)
