"""Reports about scenes: objects, regions, specifiers, mutation, external parameters, seeds."""

import os
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

import scenic
from scenic.language.errors import InvalidScenarioError, ScenicWarning
from tests.reports.programs import Programs, programs  # noqa: F401 - a fixture


def test_a_region_without_an_ego(programs: Programs) -> None:  # noqa: F811
    scene = programs.compiled("new Object in CircularRegion((0, 0), 3)\n").sample(1, seed=1)[0]
    (thing,) = scene.objects
    assert thing.position.norm() <= 3
    text = "r = CircularRegion((0, 0), 3)\nnew Object in visible r\n"
    (first,) = programs.found(text)
    assert (first.code, first.span and first.span.line) == ("SC209", 2)
    with pytest.raises(InvalidScenarioError, match="the ego object is used before it is set"):
        programs.compiled(text)


def test_many_external_parameters_keep_their_ranges(programs: Programs) -> None:  # noqa: F811
    text = "".join(f"param p{i} = VerifaiRange({i}, {i + 1})\n" for i in range(14))
    scenario = programs.compiled(f"{text}ego = new Object\n")
    for _ in range(4):
        params = scenario.generate()[0].params
        assert all(i <= params[f"p{i}"] <= i + 1 for i in range(14))


def test_grids_repeat_over_regions(programs: Programs) -> None:  # noqa: F811
    scenario = programs.compiled(
        "param verifaiSamplerType = 'grid'\nparam verifaiSamplerParams = {'N': 2, 'repeat': True}\n"
        "param p = VerifaiRange(0, 1)\nego = new Object in RectangularRegion((0, 0), 0, 4, 4)\n"
    )
    scenes = [scenario.generate()[0] for _ in range(5)]
    assert [scene.params["p"] for scene in scenes] == pytest.approx([0, 1, 0, 1, 0])
    assert len({tuple(scene.egoObject.position) for scene in scenes}) == 5


def test_external_parameters_within_modular_scenarios(programs: Programs) -> None:  # noqa: F811
    result = programs.simulated(
        "scenario Inner():\n    setup:\n        new Object at (9, 9), with width VerifaiRange(1, 2)\n"
        "        record (simulation().objects[-1].width) as width\n    compose:\n        wait\n        wait\n"
        "scenario Main():\n    setup:\n        ego = new Object with width VerifaiRange(3, 4)\n"
        "        record ego.width as own\n    compose:\n        do Inner()\n",
        3,
    )
    inner, own = ({value for _, value in result.records[name]} for name in ("width", "own"))
    assert len(inner) == len(own) == 1
    assert 1 <= min(inner) <= 2
    assert 3 <= min(own) <= 4


def test_objects_collide_after_mutation(programs: Programs) -> None:  # noqa: F811
    """Of two objects 5 cm apart one in eight pairs collides after a mutation by 1 m: no scene has such a pair."""
    scenario = programs.compiled("ego = new Object\nb = new Object at (1.05, 0)\nmutate\n")
    scenes = scenario.sample(40, seed=1)
    assert not any(a.intersects(b) for a, b in (scene.objects for scene in scenes))
    assert sum(scene.attempts for scene in scenes) > 41


@pytest.mark.parametrize("specifiers", ["with speed 5, facing 90 deg", "facing 90 deg, with speed 5"])
def test_velocity_from_heading_in_either_order(programs: Programs, specifiers: str) -> None:  # noqa: F811
    scene = programs.compiled(f"ego = new Object {specifiers}\n").generate()[0]
    assert tuple(scene.egoObject.velocity) == pytest.approx((-5, 0, 0))


def test_ego_and_workspace_of_the_top_level_in_scenarios(programs: Programs) -> None:  # noqa: F811
    scene = programs.compiled(
        "workspace = Workspace(RectangularRegion((0, 0), 0, 40, 40))\nego = new Object at (1, 2)\n"
        "scenario Main():\n    setup:\n        new Object at ego offset by (5, 0)\n        new Object in workspace\n"
    ).generate()[0]
    ego, beside, inside = scene.objects
    assert scene.egoObject is ego
    assert tuple(beside.position) == (6, 2, 0)
    assert max(abs(inside.position.x), abs(inside.position.y)) <= 20
    assert scene.workspace.containsPoint((19, 19, 0))
    assert not scene.workspace.containsPoint((21, 0, 0))


def test_all_and_not(programs: Programs) -> None:  # noqa: F811
    scenario = programs.compiled(
        "ego = new Object\nboxes = [new Object in CircularRegion((5, i * 5), 2) for i in range(2)]\n"
        "require all(not (box.position.x > 5) for box in boxes)\n"
    )
    for scene in scenario.sample(3, seed=1):
        assert max(box.position.x for box in scene.objects[1:]) <= 5


def test_filters_of_values_that_depend_on_the_object(programs: Programs) -> None:  # noqa: F811
    """The heading of a field at the object is the only positive element."""
    scenario = programs.compiled(
        "field = VectorField('field', lambda point: point.x)\nheading = (0 relative to field).yaw\n"
        "ego = new Object at (Range(1, 2), 0), with foo Uniform(*filter(lambda x: x > 0, [-1, heading, 0]))\n"
    )
    for scene in scenario.sample(5, seed=1):
        assert scene.egoObject.foo == pytest.approx(scene.egoObject.x)


def test_random_filters(programs: Programs) -> None:  # noqa: F811
    """The filter leaves one or two options, depending on the draw."""
    scenario = programs.compiled(
        "x = Range(-1, 1)\nego = new Object with width Uniform(*filter(lambda i: i > 0, [-1, x, 3])), with x x\n"
    )
    scenes = [scene.egoObject for scene in scenario.sample(40, seed=1)]
    assert all(ego.width in ({ego.x, 3} if ego.x > 0 else {3}) for ego in scenes)
    assert 0 < sum(ego.width == ego.x for ego in scenes) < 40


def test_paths_are_cut_by_footprints(programs: Programs) -> None:  # noqa: F811
    scenario = programs.compiled(
        "path = PolylineRegion([(0, 0), (10, 0)])\nego = new Object on path.intersect(RectangularRegion((0, 0), 0, 8, 8))\n"
        "box = new Object in PathRegion([(0, 9), (10, 9)]).intersect(CircularRegion((9, 9), 2).footprint)\n"
    )
    for scene in scenario.sample(10, seed=1):
        on_path, in_footprint = (each.position for each in scene.objects)
        assert 0 <= on_path.x <= 4
        assert on_path.y == pytest.approx(0)
        assert 7 <= in_footprint.x <= 10
        assert in_footprint.y == pytest.approx(9)


def test_seeds_do_not_depend_on_caches_and_hashes(tmp_path: Path) -> None:
    """A process with other hashes of strings and an empty cache draws the scene of this process."""
    path = tmp_path / "program.scenic"
    path.write_text(
        "ego = new Object\nboxes = [new Object in CircularRegion((9, 9 * i), 3) for i in {'a': 1, 'b': 2}.values()]\n"
    )
    command = (
        "import scenic, sys; s = scenic.scenarioFromFile(sys.argv[1]).sample(1, seed=5)[0]; "
        "print([tuple(o.position) for o in s.objects])"
    )
    seed = "2" if os.environ.get("PYTHONHASHSEED") == "1" else "1"
    done = subprocess.run(
        [sys.executable, "-c", command, path],
        env={**os.environ, "PYTHONHASHSEED": seed, "XDG_CACHE_HOME": str(tmp_path / "cache")},
        capture_output=True,
        text=True,
        check=True,
    )
    here = scenic.scenarioFromFile(path).sample(1, seed=5)[0]
    assert done.stdout == f"{[tuple(thing.position) for thing in here.objects]}\n"


def test_draws_of_python_at_load_are_warned_of(programs: Programs) -> None:  # noqa: F811
    """Once; draws of simulations, and those that are meant, are no mistake."""
    text = "import random\nego = new Object at (random.randint(1, 5), random.random())\n"
    with pytest.warns(ScenicWarning, match=r"`random\.randint` draws once") as caught:
        scenario = programs.compiled(text)
    assert [(item.message.code, item.lineno, item.message.help) for item in caught] == [
        ("SC407", 2, "write `DiscreteRange(1, 5)`")
    ]
    assert len({scene.egoObject.position for scene in scenario.sample(5, seed=1)}) == 1
    hidden = (
        "import random\ndef f(x):\n    return x + random.random()\nego = new Object at (f(Range(0, 1)), 0)\n"
    )
    with pytest.warns(ScenicWarning, match="draws once by Python's or NumPy's `random`"):
        scenario = programs.compiled(hidden)
    places = [scene.egoObject.position.x for scene in scenario.sample(50, seed=1)]
    assert max(places) - min(places) < 1
    behaving = "behavior B():\n    random.random()\n    wait\nego = new Object with behavior B()\n"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        programs.compiled(f"import random\n{behaving}")
        programs.compiled("import random\nrandom.seed(3)\n" + hidden)
