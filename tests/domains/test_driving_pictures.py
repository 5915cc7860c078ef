"""Pictures and pages of driving scenes show the map under the objects."""

import base64
import io
import json

import numpy as np
import pytest
import shapely

import scenic
from scenic.formats.course_page import PoseTape, course_data, course_page
from scenic.formats.html import Page, page
from scenic.formats.png import png
from tests.maps import cross, straight

PROGRAM = "model scenic.simulators.newtonian.driving_model\nego = new Car\n"
HILL = '<elevationProfile><elevation s="0" a="3" b="0.05" c="0" d="0"/></elevationProfile>'


def compiled(folder, text, program=PROGRAM, **options):
    path = folder / "map.xodr"
    path.write_text(text)
    return scenic.scenarioFromString(program, params={"map": str(path)}, **options)


def area(data, number):
    piece = data["grounds"][number]
    mesh = data["meshes"][piece["mesh"]]
    points = np.frombuffer(base64.b64decode(mesh["points"]), "<f4").reshape(-1, 3)
    faces = np.frombuffer(base64.b64decode(mesh["indices"]), "<u4").reshape(-1, 3)
    return points, shapely.union_all(shapely.polygons(points[faces][:, :, :2].astype(float)))


@pytest.mark.parametrize("flat", [True, False])
def test_a_page_shows_the_roads_around_the_objects(tmp_path, flat):
    found = compiled(tmp_path, cross(), mode2D=flat)
    network = found.workspace.network
    made = Page("driving")
    for scene in found.sample(3, seed=1):
        made.add(scene)
    data = made.data()
    assert all(piece["flat"] == flat for piece in data["grounds"])
    for scene, shown in zip(found.sample(3, seed=1), data["scenes"], strict=True):
        x, y, _ = scene.egoObject.position
        ground = shapely.union_all([area(data, number)[1] for number in shown["ground"]])
        near = shapely.Point(x, y).buffer(55)
        roads = shapely.union_all([element.polygon for element in (*network.allRoads, *network.sidewalks)])
        # Borders are simplified by 5 cm, and lines between lanes stand out by half their width.
        assert roads.intersection(near).difference(ground).area < 0.005 * roads.intersection(near).area
        assert ground.difference(roads.buffer(0.2)).difference(network.intersectionRegion.polygons).area < 1
        assert shown["least"] == 20
    # Tiles are on the page once, however many scenes show them.
    assert len(data["grounds"]) < sum(len(scene["ground"]) for scene in data["scenes"])
    assert "roadOrShoulder" not in data["scenes"][0]["regions"] or len(made.text()) < 300_000


def test_roads_with_heights_are_shown_where_they_are(tmp_path):
    found = compiled(tmp_path, straight(100.0, rest=HILL))
    made = Page("hill")
    (scene,) = found.sample(1, seed=1)
    made.add(scene)
    data = made.data()
    for number in data["scenes"][0]["ground"]:
        points, _ = area(data, number)
        np.testing.assert_allclose(points[:, 2], 3 + 0.05 * points[:, 0], atol=0.1)


def test_a_picture_shows_the_road(tmp_path):
    pillow = pytest.importorskip("PIL.Image")
    found = compiled(tmp_path, straight(100.0), PROGRAM.replace("new Car", "new Car with color (1, 0, 0)"))
    (scene,) = found.sample(1, seed=1)
    image = np.asarray(pillow.open(io.BytesIO(png(scene, (160, 120)))).convert("RGB")).astype(int)
    dark = (image.max(axis=2) < 130) & (np.ptp(image, axis=2) < 30)
    assert 0.1 < dark.mean() < 0.9
    assert ((image[..., 0] > 150) & (image[..., 1] < 100)).any()


def test_objects_of_two_dimensions_are_no_towers(tmp_path):
    """Their height is that of their longest side; on a map they are shown as cars, and on the ground."""
    found = compiled(tmp_path, straight(100.0), mode2D=True)
    (scene,) = found.sample(1, seed=1)
    assert scene.egoObject.height == 1.5
    made = Page("flat")
    made.add(scene)
    (shown,) = made.data()["scenes"][0]["objects"]
    assert shown["size"] == (2, 4.5, 1.5)
    assert shown["position"][2] == 0.75


def test_a_page_of_simulations_shows_the_whole_way_and_shares_tiles(tmp_path):
    program = PROGRAM.replace("new Car", "new Car at (10, -1.75), facing -90 deg, with velocity (30, 0, 0)")
    found = compiled(tmp_path, straight(400.0), program.replace("new Car", "new Debris"))
    made = []
    for _ in range(2):
        (scene,) = found.sample(1, seed=1)
        tape = PoseTape()
        for step in range(3):
            tape.add([((10 + 150 * step, -1.75, 0), scene.egoObject.orientation)])
        made.append(course_data(Course(scene), tape))
    data = made[0]
    ground = shapely.union_all([area(data, number)[1] for number in data["scenes"][0]["ground"]])
    assert all(ground.contains(shapely.Point(x, -1.75)) for x in (10, 160, 310))
    text = course_page("two", made)
    start = text.index(">", text.index('id="data"')) + 1
    together = json.loads(text[start : text.index("</script>", start)])
    assert [piece["layer"] for piece in together["grounds"]] == [piece["layer"] for piece in data["grounds"]]
    assert [scene["ground"] for scene in together["scenes"]] == 2 * [data["scenes"][0]["ground"]]


class Course:
    """What is known of a simulation that has run."""

    def __init__(self, scene):
        self.scene, self.objects, self.timestep = scene, scene.objects, 0.1
        self.result = type("Result", (), {"terminationReason": "end", "requirements": ()})


def test_other_workspaces_show_nothing():
    found = scenic.scenarioFromString("ego = new Object")
    text = page(found.sample(1, seed=1), "plain")
    start = text.index(">", text.index('id="data"')) + 1
    assert "grounds" not in json.loads(text[start : text.index("</script>", start)])
