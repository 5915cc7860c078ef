"""Scenes kept as data and as programs, and taken up again."""

import copy
import hashlib
import io
import json
import math
import os
import pickle
import re
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from scenic.core.distributions import Range

import scenic
from scenic import pipeline
from scenic.failures import diagnose
from scenic.language.errors import InvalidScenarioError, ScenicWarning, SerializationError
from scenic.runtime.ground.files import whole
from scenic.runtime.scenes.dumping import literal, program_of
from scenic.runtime.scenes.scenario import Scenario
from tests.runtime.programs import fingerprint, scenario
from tests.runtime.programs import scene as scene_of

PROGRAM = """
import random
class Car:
    tag: Uniform('a', 'b')
ego = new Car at (Range(0, 5), Normal(0, 1)), facing (Range(0, 3), 0.2, 0.1)
b = new Object at (Range(10, 15), 0), with shape CylinderShape(), with width Range(1, 2), with color (0.1, 0.2, 0.3)
def lucky(x):
    return random.random() < 0.5
require lucky(ego)
require[0.3] ego.position.x > 2.5
require ego.position.x > 1
mutate b
param p = Range(0, 1), q = (1, Uniform(2, 3)), r = {'k': Range(0, 1)}
"""


@pytest.mark.parametrize("prune", [True, False])
def test_a_saved_scene_is_the_same_again(tmp_path: Path, prune: bool) -> None:
    program = tmp_path / "main.scenic"
    program.write_text(PROGRAM)
    loaded = scenic.load(program, prune=prune)
    other = scenic.load(program, prune=not prune)
    for scene in loaded.sample(10, seed=5):
        scene.save(tmp_path / "one.scene")
        for again in (loaded.replay(tmp_path / "one.scene"), other.replay(tmp_path / "one.scene")):
            assert fingerprint(again) == fingerprint(scene)
        assert loaded.sceneToBytes(again) == loaded.sceneToBytes(scene)
    assert [file.name for file in tmp_path.iterdir() if file.suffix != ".scenic"] == ["one.scene"]


def _begin(path: Path, stop: type[BaseException]) -> None:
    with whole(path) as stream:
        stream.write(b"a part")
        raise stop


def test_files_may_have_long_names_and_errors_name_theirs(tmp_path: Path) -> None:
    (scene,) = scenario(PROGRAM).sample(1, seed=0)
    path = tmp_path / f"{'long' * 60}.scene"
    scene.save(path)
    assert [item.name for item in tmp_path.iterdir()] == [path.name]
    for error, name in (
        (OSError(28, "No space left on device"), str(path)),
        (FileNotFoundError(2, "missing", "other"), "other"),
    ):
        with pytest.raises(OSError, match=error.strerror) as caught, whole(path):
            raise error
        assert (caught.value.errno, caught.value.filename) == (error.errno, name)


def test_a_scene_is_saved_whole_or_not_at_all(tmp_path: Path) -> None:
    (scene,) = scenario(PROGRAM).sample(1, seed=0)
    data = scenario(PROGRAM).sceneToBytes(scene)
    before = os.umask(0o027)
    try:
        scene.save(tmp_path / "own.scene")
    finally:
        os.umask(before)
    assert (
        stat.S_IMODE((tmp_path / "own.scene").stat().st_mode) == 0o640
    )  # as of any new file, not for its maker alone
    (tmp_path / "folder").mkdir()
    with pytest.raises(IsADirectoryError):
        scene.save(tmp_path / "folder")
    with pytest.raises(FileNotFoundError):
        scene.save(tmp_path / "missing" / "own.scene")
    assert sorted(item.name for item in tmp_path.iterdir()) == ["folder", "own.scene"]
    for stop in (KeyboardInterrupt, ValueError):
        with pytest.raises(stop):
            _begin(tmp_path / "own.scene", stop)
    assert sorted(item.name for item in tmp_path.iterdir()) == ["folder", "own.scene"]
    assert (tmp_path / "own.scene").read_bytes() == data
    os.mkfifo(tmp_path / "pipe")
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    try:
        scene.save(tmp_path / "pipe")
        assert os.read(reader, 1 << 16) == data == (tmp_path / "own.scene").read_bytes()
    finally:
        os.close(reader)


def test_a_saved_scene_is_data_only(tmp_path: Path) -> None:
    loaded = scenario(PROGRAM)
    data = json.loads(loaded.sceneToBytes(loaded.sample(1, seed=0)[0]))
    assert set(data) == {
        "format",
        "version",
        "program",
        "seed",
        "scene",
        "attempts",
        "numbers",
        "words",
        "sum",
    }
    assert "lucky" not in json.dumps(data)


def test_data_of_another_program_or_damaged_is_refused() -> None:
    loaded = scenario(PROGRAM)
    (scene,) = loaded.sample(1, seed=0)
    data = loaded.sceneToBytes(scene)
    for other in (scenario(PROGRAM + "y = 1\n"), scenario(PROGRAM, params={"p": 1})):
        with pytest.raises(SerializationError, match="another program"):
            other.sceneFromBytes(data)
    assert fingerprint(scenario(PROGRAM + "y = 1\n").sceneFromBytes(data, verify=False)) == fingerprint(scene)
    remarked = scenario("# A remark.\n\n" + PROGRAM.replace("\n", "\n\n") + "# Another one.\n")
    assert fingerprint(remarked.sceneFromBytes(data)) == fingerprint(scene)
    with pytest.raises(SerializationError, match="other random values"):
        scenario("x = Range(0, 1)\nparam x = x").sceneFromBytes(data, verify=False)
    name, number = next(iter(json.loads(data)["numbers"].items()))
    borders = [
        data.replace(f'"{name}":"{number}"'.encode(), f'"{name}":"{value.hex()}"'.encode())
        for value in (0.0, 1.0, math.nan)
    ]
    for broken in (
        *borders,
        b"",
        b"{}",
        b"\xff",
        data[:-5],
        data.replace(b"0x1.", b"0x9."),
        data.replace(b'"version":2', b'"version":3'),
    ):
        with pytest.raises(SerializationError) as caught:
            loaded.sceneFromBytes(broken)
        found = diagnose(caught.value)
        assert found is not None
        assert (found.code, bool(found.help)) == ("SC607", True)


OPTIONS: list[dict[str, Any]] = [
    {},
    {"params": {"p": 1}},
    {"scenario": "Other"},
    {"mode2D": True},
    {"model": "other_world"},
]


def test_every_option_is_told_apart(tmp_path: Path) -> None:
    """By what a scene remembers of the program, and by a scenario that is pickled."""
    for name, place in (("usual_world", 3), ("other_world", 4)):
        (tmp_path / f"{name}.scenic").write_text(f"PLACE = {place}\n")
    text = "model usual_world\nparam p = 0\nscenario {}():\n    setup:\n        ego = new Object at ({}, PLACE, 7)\n"
    text = text.format("Main", "Range(0, 1)") + text.format("Other", "Range(5, 6)").split("\n", 2)[2]
    options: list[dict[str, Any]] = [{"filename": str(tmp_path / "p.scenic"), **each} for each in OPTIONS]
    programs = [scenario(text, **each) for each in options]
    scenes = [program.sample(1, seed=0)[0] for program in programs]
    found = [(int(scene.egoObject.x), *scene.egoObject.position[1:], scene.params["p"]) for scene in scenes]
    assert found == [(0, 3, 7, 0), (0, 3, 7, 1), (5, 3, 7, 0), (0, 3, 0, 0), (0, 4, 7, 0)]
    for one, scene in zip(programs, scenes, strict=True):
        data = one.sceneToBytes(scene)
        for other in programs:
            if other is not one:
                with pytest.raises(SerializationError, match="another program"):
                    other.sceneFromBytes(data)
        again = pickle.loads(pickle.dumps(one))
        assert fingerprint(again.sceneFromBytes(data)) == fingerprint(scene)


def test_a_dumped_scene_compiles_back_to_itself() -> None:
    loaded = scenario(PROGRAM)
    for scene in loaded.sample(10, seed=1):
        stream = io.StringIO()
        scene.dumpAsScenicCode(stream)
        assert stream.getvalue() == scene.dump()
        (again,) = scenario(scene.dump()).sample(1, seed=99)
        assert again.params == scene.params
        for old, new in zip(scene.objects, again.objects, strict=True):
            assert type(old).__name__ == type(new).__name__
            kept = dict(old.properties)
            for name in ("mutationScale", "allowCollisions", "regionContainedIn", "shape", "mutator"):
                kept.pop(name)
            for name, value in kept.items():
                assert getattr(new, name) == pytest.approx(value) if isinstance(value, float) else True, name
            assert tuple(new.position) == tuple(old.position)
            assert new.orientation.approxEq(old.orientation)
            assert repr(new.shape) == repr(old.shape)


def test_all_that_is_said_of_an_object_is_in_the_dump() -> None:
    text = """
spot = new OrientedPoint at (4, 5, 6), facing (0.3, 0.2, 0.1)
def pillar(x):
    return new Object at (x, 9, 0), with shape CylinderShape(sections=5, initial_rotation=(0.1, 0.2, 0.3))
ego = new Object with viewAngles (90 deg, 40 deg), with far -1e400, with near 1e400, with one (1,), with beside spot
for x in (3, 6):
    post = pillar(x)
param low = -1e400, single = ('a',)
"""
    before = scene_of(text)
    again = scene_of(before.dump())
    assert again.params == before.params
    ego = again.egoObject
    assert tuple(ego.viewAngles) == pytest.approx(tuple(before.egoObject.viewAngles))
    assert (ego.far, ego.near, ego.one) == (float("-inf"), float("inf"), (1,))
    assert tuple(ego.beside.position) == (4, 5, 6)
    assert ego.beside.orientation.approxEq(before.egoObject.beside.orientation)
    for old, new in zip(before.objects, again.objects, strict=True):
        assert new.shape.mesh.vertices == pytest.approx(old.shape.mesh.vertices)
        assert (new.width, new.length, new.height) == (old.width, old.length, old.height)


@pytest.mark.parametrize(
    "options",
    ["", ", unify=False", ", unify=False, scale=2", ", initial_rotation=(1, 0, 0), dimensions=(1, 2, 3)"],
)
def test_shapes_of_files_are_dumped_as_they_are_read(tmp_path: Path, options: str) -> None:
    """Two bodies that overlap are one or two."""
    bodies = [trimesh.creation.box(), trimesh.creation.box().apply_translation((0.5, 0.25, 0.125))]
    trimesh.util.concatenate(bodies).export(tmp_path / "two.obj")
    text = f"ego = new Object with shape MeshShape.fromFile({str(tmp_path / 'two.obj')!r}{options})\n"
    before = scene_of(text)
    after = scene_of(before.dump())
    old, new = before.egoObject.shape, after.egoObject.shape
    assert len(new.mesh.faces) == len(old.mesh.faces)
    assert (len(new.mesh.faces) == 24) is ("unify" in options)
    assert new.mesh.vertices == pytest.approx(old.mesh.vertices)
    assert new.dimensions == pytest.approx(old.dimensions)
    assert new.source == old.source


@pytest.mark.parametrize("mode_2d", [False, True])
@pytest.mark.parametrize(
    "said",
    [
        "with viewAngle 30 deg",
        "with viewAngles (30 deg, 20 deg)",
        "with viewAngle 30 deg, with viewAngles (1, 0.5)",
        "with headingStdDev 0.5, with positionStdDev (1, 2, 3)",
        "with orientationStdDev (0.1, 0.2, 0.3), with visibleDistance 7, with viewRayCount (20, 10)",
        "facing 0.7, with speed 3",
        "with velocity (1, 2, 3), with width 3, with length 2",
        "with height 7, with baseOffset (1, 2, 3), with occluding True",
    ],
)
def test_an_object_of_a_dump_has_all_properties_as_they_were(said: str, mode_2d: bool) -> None:
    """Also those that others follow, and that no longer agree with them; but for what the dump takes away."""
    before = scene_of(f"ego = new Object at (1, 2), {said}\n", mode2D=mode_2d)
    after = scene_of(before.dump(), mode2D=mode_2d)
    taken = {"mutator", "allowCollisions", "regionContainedIn", "requireVisible"}
    old, new = (
        {name: value for name, value in scene.egoObject.properties.items() if name not in taken}
        for scene in (before, after)
    )
    assert old.keys() == new.keys()
    for name, value in old.items():
        assert literal(new[name]) == literal(value), name


def test_parameters_of_any_name_are_dumped() -> None:
    """Words of the language and of Python, and what is no word at all; whether their values have literals or not."""
    names = ("class", "at", "visible", "ego", "two words", "two\nlines", "3", "it's")
    written = ", ".join(f"{name!r} = {number}" for number, name in enumerate(names))
    before = scene_of(f"param {written}\nparam 'odd\\nname' = CircularRegion((0, 0), 1)\n")
    assert len(before.params) == len(names) + 1
    assert dict(scene_of(before.dump()).params) == {name: number for number, name in enumerate(names)}


def test_two_objects_of_one_name_have_two_in_the_dump() -> None:
    (first, second, third) = scene_of(
        "ego = new Object\nnew Object at (3, 0)\nnew Object at (6, 0)\n"
    ).objects
    text = program_of((first, second, third), first, {}, {second: "post", third: "post"})
    names = [line.split(" = ")[0] for line in text.splitlines() if " = new " in line]
    assert names == ["ego", "post", "object_2"]


def test_what_has_no_literal_is_told_in_comments() -> None:
    """One line for each, whatever the value's text is: the dump still compiles, and nothing else is lost."""
    text = """
import numpy
class Mark(Point):
    size: 2
other = new Object at (9, 9)
ego = new Object with zone CircularRegion((0, 0), 2), with odd numpy.eye(9), with third PolygonalRegion([(0, 0), (1, 0), (0, 1)]), with size 7,
    with friend other, with mark (new Mark at (1, 2)), with spot (new Point at (7, 8))
param odd = numpy.zeros((9, 9)), place = CircularRegion((0, 0), 1), number = 5
"""
    dump = scene_of(text).dump()
    comments = [line.strip() for line in dump.splitlines() if line.strip().startswith("#")]
    found = {}
    for line in comments:
        name, told = line.removeprefix("# ").split(": ", 1)
        assert len(told) <= 80
        found[name] = told
    assert set(found) == {"param odd", "param place", "zone", "odd", "third", "friend", "mark"}
    assert found["param place"] == found["zone"] == "a CircularRegion"
    assert found["third"] == "a PolygonalRegion"
    for name, word in (("param odd", "0."), ("odd", "1.")):
        assert found[name].startswith(f"array([[{word}, 0.")
        assert len(found[name]) == 80
    again = scene_of(dump)
    assert (again.egoObject.size, dict(again.params)) == (7, {"number": 5})
    assert again.egoObject.spot.position == (7, 8)


def test_a_saved_scene_has_all_draws_of_the_program_and_no_other() -> None:
    loaded = scenario("ego = new Object at (Range(0, 1), Range(0, 1))\nparam x = Range(0, 1)\n")
    data = json.loads(loaded.sceneToBytes(loaded.sample(1, seed=0)[0]))
    address, number = data["numbers"].popitem()
    for numbers, words in (({}, {}), ({address: number, "01": number}, {}), ({address: number}, {"01": "0"})):
        changed = data | {"numbers": data["numbers"] | numbers, "words": words}
        with pytest.raises(SerializationError, match="other random values"):
            loaded.sceneFromBytes(sealed(changed))
    for outside in (0.0, 1.0):
        changed = data | {"numbers": data["numbers"] | {address: outside.hex()}}
        with pytest.raises(SerializationError, match="outside of the unit interval"):
            loaded.sceneFromBytes(sealed(changed))


def sealed(data: dict[str, Any]) -> bytes:
    """Data of a scene with the checksum that belongs to it."""
    body = json.dumps({name: value for name, value in data.items() if name != "sum"}).encode()[:-1]
    return body + b',"sum":"' + hashlib.sha256(body).hexdigest()[:32].encode() + b'"}'


def test_every_bit_counts() -> None:
    """A saved scene in which a bit flips is refused."""
    loaded = scenario("ego = new Object at (Range(0, 1), 0)")
    data = loaded.sceneToBytes(loaded.sample(1, seed=0)[0])
    for place in range(8 * len(data)):
        changed = bytearray(data)
        changed[place // 8] ^= 1 << place % 8
        with pytest.raises(SerializationError):
            loaded.sceneFromBytes(bytes(changed))


def test_unpickled_scenes_share_a_program(monkeypatch: pytest.MonkeyPatch) -> None:
    """A process compiles the program once, and evaluates a scene when it is looked at."""
    loaded = scenario("ego = new Object at (Range(0, 1), 0)")
    scenes = loaded.sample(20, seed=0)
    pickled = [pickle.dumps(scene) for scene in scenes]
    compiled = []
    run = pipeline._run
    monkeypatch.setattr(pipeline, "_run", lambda *given: compiled.append(given) or run(*given))
    again = [pickle.loads(data) for data in pickled]
    assert not compiled
    assert [scene.egoObject.x for scene in again] == [scene.egoObject.x for scene in scenes]
    assert [scene.k for scene in again] == list(range(20))
    assert len(compiled) == 1
    assert pickle.dumps(pickle.loads(pickled[0])) == pickled[0]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda loaded: loaded.sample(1, seed=1.5), "`seed` must be an integer, not 1.5"),
        (lambda loaded: loaded.sample(1, seed="abc"), "`seed` must be an integer, not 'abc'"),
        (lambda loaded: loaded.sample(-1), "`n` must be an integer of at least 0, not -1"),
        (
            lambda loaded: list(loaded.stream(1, seed=1, first=-2)),
            "`first` must be an integer of at least 0, not -2",
        ),
        (lambda loaded: loaded.sample(1, max_attempts=0), "`max_attempts` must be an integer of at least 1"),
        (lambda loaded: loaded.sample(1, time_limit=0), "`time_limit` must be a positive number of seconds"),
        (lambda loaded: loaded.simulate(1, seed="x"), "`seed` must be an integer, not 'x'"),
        (lambda loaded: loaded.simulate(-1), "`n` must be an integer of at least 0, not -1"),
        (
            lambda loaded: loaded.simulate(1, max_steps=-1),
            "`max_steps` must be an integer of at least 0, not -1",
        ),
        (
            lambda loaded: loaded.simulate(1, timestep=0),
            "`timestep` must be a positive number of seconds, not 0",
        ),
        (
            lambda loaded: loaded.found(1, np.array([0, -3]), np.array([1, 1])),
            "`numbers` must be integers of at least 0, not [0, -3]",
        ),
        (
            lambda loaded: loaded.found(1, np.array([0]), np.array([0])),
            "`attempts` must be integers of at least 1, not [0]",
        ),
        (lambda loaded: loaded.generateBatch(-1), "`n` must be an integer of at least 0, not -1"),
        (
            lambda loaded: loaded.generateBatch(1, maxIterations=0),
            "`maxIterations` must be a number of at least 1, not 0",
        ),
        (
            lambda loaded: loaded.generateStream(2.5),
            "`numScenes` must be an integer of at least 0, not 2.5",
        ),
        (
            lambda loaded: loaded.generateStream(bufferSize=0),
            "`bufferSize` must be an integer of at least 1, not 0",
        ),
    ],
)
def test_numbers_that_cannot_be_are_refused(call: Callable[[Scenario], object], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        call(scenario("ego = new Object at (Range(0, 1), 0)"))


def test_scenes_conditioned_on_one_keep_what_was_named() -> None:
    loaded = scenario(PROGRAM + "param fixed = 3\n")
    (first,) = loaded.sample(1, seed=3)
    loaded.conditionOn(first, objects=[0], params=["p"])
    later = loaded.sample(20, seed=4)
    assert {tuple(item.egoObject.position) for item in later} == {tuple(first.egoObject.position)}
    assert {item.egoObject.tag for item in later} == {first.egoObject.tag}
    assert {item.params["p"] for item in later} == {first.params["p"]}
    assert len({item.params["r"]["k"] for item in later}) == 20
    assert len({item.objects[1].position.x for item in later}) == 20
    assert fingerprint(loaded.sceneFromBytes(loaded.sceneToBytes(later[3])))[1:] == fingerprint(later[3])[1:]
    for missing in ({"objects": [99]}, {"objects": [-99]}, {"params": ["missing"]}):
        with pytest.raises(InvalidScenarioError, match=r"no object|no parameter") as refused:
            loaded.conditionOn(first, **missing)
        assert refused.value.help
    loaded.conditionOn()
    assert len({item.params["p"] for item in loaded.sample(5, seed=4)}) == 5
    # What depends on nothing random fixes nothing.
    for nothing in ({}, {"objects": [], "params": []}, {"objects": [], "params": ["fixed"]}):
        loaded.conditionOn(first, **nothing)
        assert len({item.params["p"] for item in loaded.sample(5, seed=4)}) == 5
    # A loop foresees scenes; those of before count no more.
    free = [loaded.generate()[0].params["p"] for _ in range(4)]
    loaded.conditionOn(first, params=["p"])
    assert {loaded.generate()[0].params["p"] for _ in range(12)} == {first.params["p"]}
    loaded.conditionOn()
    assert first.params["p"] not in free + [loaded.generate()[0].params["p"] for _ in range(12)]


def test_a_scene_is_that_of_its_own_program_whoever_writes_it() -> None:
    one, other = (scenario(f"ego = new Object at (Range(0, {end}), 0)\n") for end in (1, 2))
    (scene,) = one.sample(1, seed=3)
    data = other.sceneToBytes(scene)
    assert data == one.sceneToBytes(scene)
    assert fingerprint(one.sceneFromBytes(data)) == fingerprint(scene)
    with pytest.raises(SerializationError):
        other.sceneFromBytes(data)


def test_objects_are_named_by_their_places_among_those_of_scenes() -> None:
    """The ego comes first there, not in the program."""
    loaded = scenario("a = new Object at (Range(0, 1), 5)\nego = new Object at (Range(0, 1), 9)\n")
    (first,) = loaded.sample(1, seed=3)
    for place in (0, 1, -1, -2):
        loaded.conditionOn()
        loaded.conditionOn(first, objects=[place])
        later = loaded.sample(5, seed=4)
        for number, item in enumerate(first.objects):
            found = {thing.objects[number].position.x for thing in later}
            assert (found == {item.position.x}) == (number == place % 2)


def test_exceptions_of_the_program_keep_their_type_and_tell_the_place() -> None:
    text = "x = Range(0, 1)\ndef f(v):\n    return {}[v]\nrequire f(x)\n"
    with pytest.raises(KeyError) as caught:
        scenario(text).sample(1, seed=0)
    (note,) = caught.value.__notes__
    assert "<string>:4:1: requirement on line 4 failed: KeyError" in note
    assert "attempt 0 at scene 0" in note
    with pytest.raises(KeyError) as caught:
        scenario("x = 1\ny = {}[x]\n")
    assert "<string>:2:5" in caught.value.__notes__[0]


def test_a_scene_is_shown_as_a_page(monkeypatch: pytest.MonkeyPatch) -> None:
    import webbrowser

    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    (scene,) = scenario(PROGRAM).sample(1, seed=0)
    for show in (scene.show, scene.show2D, scene.show3D):
        file = show()
        assert "<html" in file.read_text().lower()
        assert opened[-1] == file.as_uri()


def test_what_is_fixed_stays_so_wherever_the_other_numbers_come_from() -> None:
    program = scenario("x = Range(0, 1)\ny = Range(0, 1)\nparam x = x, y = y\n")
    known = program.sample(1, seed=3)[0]
    program.conditionOn(known, params=["x"])
    rows = scenic.GivenPoints(np.linspace(0.1, 0.9, 16).reshape(8, 2))
    for source in (None, scenic.Sobol(), rows):
        found = program.sample(8, seed=1, source=source)
        assert {each.params["x"] for each in found} == {known.params["x"]}
        assert len({each.params["y"] for each in found}) == 8
    for _ in range(3):
        assert program.generate()[0].params["x"] == known.params["x"]


def test_axes_name_the_draws_that_their_places_make() -> None:
    """In the order of the columns of points: by the address under which a scene keeps the number, and by place."""
    names = [f"x{number}" for number in range(7)]
    program = scenario(
        "".join(f"{name} = Range(0, 1)\n" for name in names) + "param all = [" + ", ".join(names) + "]\n"
    )
    assert sorted(axis.span.line for axis in program.axes if axis.span) == list(range(1, 8))
    row = np.linspace(0.1, 0.7, 7)
    (found,) = program.sample(1, seed=0, source=scenic.GivenPoints([row]))
    kept = json.loads(program.sceneToBytes(found))["numbers"]
    numbers = {int(address, 16): float.fromhex(number) for address, number in kept.items()}
    for place, axis in zip(row, program.axes, strict=True):
        assert axis.span is not None
        assert found.params["all"][axis.span.line - 1] == place
        assert numbers[axis.address] == place


def test_numbers_and_texts_of_any_type_are_dumped_as_what_they_are() -> None:
    """Those of NumPy, and of classes derived from Python's own, such as enumerations, show themselves otherwise."""
    before = scene_of("""
import collections, enum, numpy
class Kind(enum.IntEnum):
    CAR = 7
class Name(str):
    def __repr__(self): return '<name>'
class Metres(float):
    def __repr__(self): return '2.5 m'
Pair = collections.namedtuple('Pair', 'first second')
param kind = Kind.CAR, name = Name("it's"), long = Metres(2.5), endless = Metres('-inf'), pair = Pair(1, [2, (3,)])
param single = numpy.float32(0.1), double = numpy.float64(0.1), whole = numpy.int64(2**53 + 1), yes = numpy.bool_(True)
param nested = {1: [numpy.float64(1), numpy.float64('inf')], 'none': None, (1, 2): {'a': numpy.uint8(9)}, 2: [], 3: {}, 4: ()}
param missing = float('nan'), own = True, other = 2**70, small = 5e-324, text = numpy.str_('t'), imaginary = numpy.complex128(1)
ego = new Object with width numpy.float64(2), with kind Kind.CAR, with zone everywhere, with marks [numpy.int32(3)]
""")
    dump = before.dump()
    assert [line for line in dump.splitlines() if "#" in line] == ["# param imaginary: np.complex128(1+0j)"]
    again = scene_of(dump)
    found = dict(again.params)
    assert math.isnan(found.pop("missing"))
    assert found == {
        "kind": 7,
        "name": "it's",
        "long": 2.5,
        "endless": -math.inf,
        "pair": (1, [2, (3,)]),
        "single": float(np.float32(0.1)),
        "double": 0.1,
        "whole": 2**53 + 1,
        "yes": True,
        "nested": {1: [1, math.inf], "none": None, (1, 2): {"a": 9}, 2: [], 3: {}, 4: ()},
        "own": True,
        "other": 2**70,
        "small": 5e-324,
        "text": "t",
    }
    assert (found["yes"], found["own"]) == (True, True)
    assert {type(found["yes"]), type(found["own"])} == {bool}
    ego = again.egoObject
    assert (ego.width, ego.kind, ego.marks) == (2, 7, [3])
    assert ego.zone is before.egoObject.zone  # everywhere


def test_what_is_fixed_first_stays_so_unless_it_is_fixed_anew() -> None:
    """Numbers and words: those of a volume have both."""
    program = scenario("""
ego = new Object in MeshVolumeRegion(ConeShape().mesh, dimensions=(3, 3, 3))
other = new Object in MeshVolumeRegion(ConeShape().mesh, dimensions=(3, 3, 3), position=(9, 0, 0))
param x = Range(0, 1), y = Range(0, 1)
""")
    first, second = program.sample(2, seed=3)
    kept = json.loads(program.sceneToBytes(first))
    assert kept["numbers"]
    assert kept["words"]

    def values() -> set[tuple[Any, ...]]:
        return {
            (tuple(item.objects[0].position), tuple(item.objects[1].position), *item.params.values())
            for item in program.sample(4, seed=9)
        }

    program.conditionOn(first, objects=[program.objects[0]])  # an object itself
    program.conditionOn(first, params=["x"])
    program.conditionOn(second, objects=[-1], params=["y"])
    expected = (
        tuple(first.objects[0].position),
        tuple(second.objects[1].position),
        first.params["x"],
        second.params["y"],
    )
    assert values() == {expected}
    program.conditionOn(second, objects=[0], params=["x"])
    assert values() == {
        (
            tuple(second.objects[0].position),
            tuple(second.objects[1].position),
            second.params["x"],
            second.params["y"],
        )
    }
    program.conditionOn()
    assert len(values()) == 4


@pytest.mark.parametrize("source", [None, scenic.Sobol()])
def test_scenes_stay_what_they_are_whatever_is_fixed_later(source: Any) -> None:
    """Those that were found, as data too, and those of a stream that has begun."""
    program = scenario("ego = new Object at (Range(0, 1), 0)\nparam x = Range(0, 1), y = Range(0, 1)\n")
    other, known = program.sample(2, seed=3)

    def assert_unchanged_by(**later: Any) -> None:
        streams = [program.stream(4, seed=5, lanes=1, source=source) for _ in range(2)]
        expected = [fingerprint(item) for item in streams[0]]
        first = next(streams[1])
        data = program.sceneToBytes(first)
        program.conditionOn(**later)
        assert program.sceneToBytes(first) == data
        for again in (program.sceneFromBytes(data), pickle.loads(pickle.dumps(first)), copy.deepcopy(first)):
            assert fingerprint(again)[1:] == expected[0][1:]
        assert [fingerprint(item) for item in (first, *streams[1])] == expected

    assert_unchanged_by(scene=known, params=["x"])
    assert_unchanged_by(scene=other, params=["x", "y"])
    assert_unchanged_by(scene=other, objects=[0])
    assert_unchanged_by()
    assert_unchanged_by(scene=known, objects=[0])


def test_what_holds_an_object_is_its_own_region_or_else_the_workspace() -> None:
    program = scenario("""
workspace = Workspace(RectangularRegion((0, 0), 0, 9, 9))
ego = new Object
inner = new Object at (3, 3), with regionContainedIn CircularRegion((3, 3), 2)
""")
    ego, inner = program.objects
    assert program.containerOfObject(ego) is program.workspace.region
    assert program.containerOfObject(inner) is inner.regionContainedIn
    (free,) = (bare := scenario("ego = new Object\n")).objects
    assert bare.containerOfObject(free).containsPoint((1e9, 0, 0))


def test_copies_of_a_scenario_are_itself() -> None:
    """What was sampled before changes nothing; so there is nothing to keep apart, and nothing random to rename."""
    program = scenario(PROGRAM)
    for again in (copy.copy(program), copy.deepcopy(program), copy.deepcopy([program])[0]):
        assert again is program


def test_a_dump_goes_to_the_standard_output_unless_a_stream_is_given(
    capsys: pytest.CaptureFixture[str],
) -> None:
    (scene,) = scenario(PROGRAM).sample(1, seed=1)
    scene.dumpAsScenicCode()
    assert capsys.readouterr().out == scene.dump()
    scene.dumpAsScenicCode(io.StringIO())
    assert capsys.readouterr().out == ""


def test_values_of_the_language_are_dumped_as_parameters() -> None:
    """Vectors, orientations, shapes, points, and what holds them."""
    before = scene_of("""
turn = Orientation.fromEuler(0.3, 0.2, 0.1)
param place = Vector(1, 2, 3), turn = turn, flags = (True, None, False)
param cone = ConeShape(dimensions=(1, 2, 3)), nested = {'a': [Vector(0, 0, 1), (turn,)]}
param spot = new Point at (1, 2, 3), own = new OrientedPoint at (4, 5, 6), facing (0.5, 0.25, 0.125)
class Car:
    goal: Vector(7, 8, 9)
    aim: turn
    hull: SpheroidShape(dimensions=(3, 2, 1))
ego = new Car
""")
    with pytest.warns(ScenicWarning, match="no property 'goal'|no property 'aim'|no property 'hull'"):
        again = scene_of(before.dump())
    assert "#" not in before.dump()
    old, new = before.params, again.params
    assert set(old) == set(new)
    assert new["place"] == tuple(old["place"]) == (1, 2, 3)
    assert new["flags"] == (True, None, False)
    assert new["nested"]["a"][0] == (0, 0, 1)
    for one, other in (
        (old["turn"], new["turn"]),
        (old["turn"], new["nested"]["a"][1][0]),
        (old["own"].orientation, new["own"].orientation),
        (old["turn"], again.egoObject.aim),
    ):
        assert one.approxEq(other, 1e-12)
    assert new["spot"].position == (1, 2, 3)
    assert new["own"].position == (4, 5, 6)
    assert type(new["cone"]).__name__ == "ConeShape"
    assert new["cone"].dimensions == (1, 2, 3)
    assert again.egoObject.goal == (7, 8, 9)
    assert again.egoObject.hull.dimensions == (3, 2, 1)


def test_a_dumped_scene_is_judged_no_more() -> None:
    """What it was sampled for was decided then: its objects may touch, lie outside of everything and be unseen."""
    before = scene_of("""
workspace = Workspace(CircularRegion((0, 0), 20))
ego = new Object with allowCollisions True, with requireVisible False
class Car:
    regionContainedIn: CircularRegion((9, 9), 5)
    requireVisible: True
    mutationScale: 0
other = new Car at (0.5, 9), with requireVisible False
new Object at (0.5, 0), with mutationScale 3
mutate other
require ego.x < 3
""")
    for number in range(3):
        (again,) = scenario(before.dump()).sample(1, seed=number)
        assert [tuple(item.position) for item in again.objects] == [
            tuple(item.position) for item in before.objects
        ]
        assert [type(item).__name__ for item in again.objects] == ["Object", "Car", "Object"]
        assert again.program.requirements == []
        assert again.dump() == before.dump()


def test_data_with_anything_else_in_one_place_is_damaged() -> None:
    program = scenario("ego = new Object at (Range(0, 1), 0)\n")
    (scene,) = program.sample(1, seed=2)
    data = program.sceneToBytes(scene)
    (address,) = json.loads(data)["numbers"]
    for changed in (
        {"numbers": [1]},
        {"numbers": {"no number": "0x1p-1"}},
        {"numbers": {address: 0.5}},
        {"words": {"0": 3}},
        {"attempts": "many"},
        {"seed": None},
        {"format": "another"},
        {"version": "1"},
        {"version": 0},
    ):
        with pytest.raises(SerializationError, match="cannot be read"):
            program.sceneFromBytes(json.dumps(json.loads(data) | changed).encode())
    for missing in json.loads(data):
        kept = {name: value for name, value in json.loads(data).items() if name != missing}
        with pytest.raises(SerializationError, match="cannot be read"):
            program.sceneFromBytes(json.dumps(kept).encode())


def test_a_scene_tells_its_number_seed_and_attempts_again() -> None:
    """From data and from a file whose path is a text; a fresh scene of the same scenario has its own."""
    program = scenario("x = Range(0, 1)\nparam x = x\ndef same(v): return v\nrequire same(x < 0.3)\n")
    scenes = program.sample(6, seed=2**70 - 1)
    assert max(scene.attempts for scene in scenes) > 1
    for scene in scenes:
        again = program.sceneFromBytes(program.sceneToBytes(scene))
        assert (again.seed, again.k, again.attempts) == (scene.seed, scene.k, scene.attempts)
        assert (again.seed, repr(again)) == (2**70 - 1, repr(scene))
        assert again.params == scene.params
        assert program.sceneToBytes(again) == program.sceneToBytes(scene)
    assert repr(scenes[2]) == f"<Scene 2 of seed {2**70 - 1}: 0 objects>"


def test_files_of_scenes_are_named_by_texts_or_paths(tmp_path: Path) -> None:
    program = scenario(PROGRAM)
    (scene,) = program.sample(1, seed=4)
    for path in (tmp_path / "one", str(tmp_path / "two")):
        scene.save(path)
        for named in (Path(path), str(path)):
            assert fingerprint(program.replay(named)) == fingerprint(scene)


def test_names_and_classes_of_a_dump_are_those_of_the_program() -> None:
    """Members of lists have no name of their own; objects of the language's class need no class."""
    before = scene_of("""
class Car:
    spot: None
class Spot(OrientedPoint):
    kind: 3
posts = [new Object at (3 * i, 9) for i in range(2)]
car = new Car at (0, 20), with spot (new Spot at (1, 2, 3), facing (0.5, 0.25, 0.125))
ego = new Object
other = ego
""")
    dump = before.dump()
    made = [line.split(" at ")[0] for line in dump.splitlines() if " = new " in line]
    assert made == ["ego = new Object", "object_1 = new Object", "object_2 = new Object", "car = new Car"]
    assert [line for line in dump.splitlines() if line.startswith("class")] == ["class Car:"]
    again = scene_of(dump)
    spot = again.objects[3].spot
    assert spot.position == (1, 2, 3)
    assert spot.orientation.approxEq(before.objects[3].spot.orientation, 1e-12)


def test_a_scene_that_is_taken_up_again_shows_all_that_it_showed() -> None:
    """Also what its objects are not made of: regions of variables, and every other value, from what they have in common."""
    program = scenario(
        "a = Range(0, 1)\nb = a * 2\np = new Point at (b + 3, b)\nr = CircularRegion((b + 3, 7 - b), 2)\n"
        "ego = new Object at (b + 3, 7), with width a + 1\n"
    )
    for scene in program.sample(3, seed=3):
        again = program.sceneFromBytes(program.sceneToBytes(scene))
        region, other = scene.regions["r"], again.regions["r"]
        assert (region.center, region.radius) == (other.center, other.radius)
        for node in program.outline.graph.nodes:
            assert again.lookup(node) == scene.lookup(node)


def test_parameters_are_conditioned_on_values_and_on_distributions() -> None:
    program = scenario(
        "param x = Range(0, 1)\nparam y = Range(0, 1)\nego = new Object at (globalParameters.x, Range(0, 1))\n"
    )
    (first,) = program.sample(1, seed=1)
    program.conditionOn(first, params=["y"])
    program.conditionOn(params={"x": 0.6})
    later = program.sample(5, seed=2)
    assert {(item.params["x"], item.egoObject.position.x) for item in later} == {(0.6, 0.6)}
    assert {item.params["y"] for item in later} == {first.params["y"]}  # The earlier condition stays.
    assert len({item.egoObject.position.y for item in later}) == 5
    again = program.sceneFromBytes(program.sceneToBytes(later[0]))
    assert again.egoObject.position == later[0].egoObject.position
    # A scene of before still tells values.
    program.conditionOn(first, objects=[0])
    assert {item.egoObject.position.y for item in program.sample(3, seed=3)} == {first.egoObject.position.y}
    program.conditionOn()
    assert len({(item.params["x"], item.params["y"]) for item in program.sample(5, seed=2)}) == 5
    program.conditionOn(params={"x": Range(0.6, 0.7)})
    drawn = {program.generate()[0].params["x"] for _ in range(5)}
    assert len(drawn) == 5
    assert all(0.6 < x < 0.7 for x in drawn)
    with pytest.raises(InvalidScenarioError, match="no parameter 'z'"):
        program.conditionOn(params={"z": 1})
    with pytest.raises(InvalidScenarioError, match="without a scene"):
        program.conditionOn(params=["x"])


def test_parameters_that_are_vectors_are_dumped_as_vectors() -> None:
    program = scenario("param v = Vector(1, 2, 3)\nego = new Object at (1, 2)\n")
    stream = io.StringIO()
    program.sample(1, seed=1)[0].dumpAsScenicCode(stream)
    text = stream.getvalue()
    again = scenario(text).sample(1, seed=1)[0]
    assert type(again.params["v"]) is type(again.egoObject.position)
    assert tuple(again.params["v"]) == (1, 2, 3)
