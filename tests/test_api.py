"""The Python API: loading, parameters, modules, models, the choice of a scenario, scenes."""

import pickle
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import scenic
from scenic.deep.findings import deep_check
from scenic.failures import diagnose
from scenic.language.errors import InvalidScenarioError, Located, ScenarioChoiceError, ScenicSyntaxError
from scenic.language.spans import Span


@pytest.fixture
def folder(tmp_path: Path) -> Any:
    """Writes files beside each other and loads them."""

    def write(**files: str) -> None:
        for name, text in files.items():
            (tmp_path / f"{name}.scenic").write_text(text)

    def load(_name: str = "main", **options: Any) -> scenic.Scenario:
        return scenic.load(tmp_path / f"{_name}.scenic", **options)

    return SimpleNamespace(path=tmp_path, write=write, load=load)


def params(program: scenic.Scenario) -> dict[str, Any]:
    (scene,) = program.sample(1, seed=0)
    return scene.params


def test_files_and_texts_give_the_same(folder: Any) -> None:
    text = "ego = new Object at (Range(0, 1), 0)\nparam where = localPath('x').name\n"
    folder.write(main=text)
    path = folder.path / "main.scenic"
    positions = {
        tuple(program.sample(1, seed=3)[0].egoObject.position)
        for program in (
            folder.load(),
            scenic.load(str(path)),
            scenic.scenarioFromFile(path),
            scenic.scenarioFromFile(str(path)),
            scenic.scenarioFromString(text),
            scenic.scenarioFromString(text, filename=str(path)),
        )
    }
    assert len(positions) == 1
    assert scenic.load(path).filename == str(path)


def test_missing_files(tmp_path: Path) -> None:
    for function in (scenic.load, scenic.scenarioFromFile):
        with pytest.raises(Exception, match=r"nothing\.scenic") as caught:
            function(tmp_path / "nothing.scenic")
        found = diagnose(caught.value)
        assert isinstance(caught.value, FileNotFoundError) or found is not None


def test_scenes() -> None:
    program = scenic.scenarioFromString(
        "a = new Object at (5, 5)\nego = new Object at (Range(0, 1), 0)\nbs = [new Object at (9, i * 3) for i in range(2)]\n"
        "param x = ego.x, y = 'text'\nworkspace = Workspace(CircularRegion((0, 0), 50))\n"
    )
    (scene,) = program.sample(1, seed=0)
    assert scene.egoObject is scene.objects[0]
    assert [tuple(item.position)[:2] for item in scene.objects[1:]] == [(5, 5), (9, 0), (9, 3)]
    assert [scene.names[item] for item in scene.objects] == ["ego", "a", "bs[0]", "bs[1]"]
    assert scene.params == {"x": scene.egoObject.x, "y": "text"}
    assert (scene.seed, scene.k) == (0, 0)
    assert scene.workspace is program.workspace
    assert program.egoObject is program.objects[0]
    assert len(program.requirements) == 0
    assert list(program.params) == ["x", "y"]
    empty = scenic.scenarioFromString("param x = 1").sample(1, seed=0)[0]
    assert (empty.egoObject, empty.objects) == (None, ())


def test_changing_the_parameters_that_are_given_out_changes_no_scene() -> None:
    program = scenic.scenarioFromString("param x = Range(0, 1), y = 'text'")
    (before,) = program.sample(1, seed=0)
    expected = dict(before.params)
    for given in (program.params, before.params):
        given["x"] = given["z"] = 7
        del given["y"]
    assert list(program.params) == ["x", "y"]
    (after,) = program.sample(1, seed=0)
    assert after.params == expected


def test_names_of_objects_are_those_of_the_first_variables_that_hold_them() -> None:
    scene = scenic.scenarioFromString(
        "first = new Object\nsecond = first\ncars = [new Object at (x, 0) for x in (3, 6)]\n"
        "pair = (cars[0], new Object at (9, 0))\nego = cars[1]\n_own = new Object at (12, 0)\n"
        "new Object at (15, 0)\nplace = new Point at (1, 2)\n"
        "disc, _hidden, all_of_it = CircularRegion((0, 0), 1), CircularRegion((0, 0), 2), everywhere\n"
    ).sample(1, seed=0)[0]
    found = {item.position.x: name for item, name in scene.names.items()}
    assert found == {0: "first", 3: "cars[0]", 6: "cars[1]", 9: "pair[1]", 12: "_own"}
    assert set(scene.regions) == {"disc"}
    alone = scenic.scenarioFromString("ego = new Object").sample(1, seed=0)[0]
    assert alone.names == {alone.egoObject: "ego"}


# Parameters


def test_parameters_and_overrides(folder: Any) -> None:
    folder.write(
        main="param a = 1, b = 2, 'c d' = 3\nparam a = 4\nparam e = globalParameters.a + globalParameters['b']\n"
    )
    assert params(folder.load()) == {"a": 4, "b": 2, "c d": 3, "e": 6}
    assert params(folder.load(params={"a": 10})) == {"a": 10, "b": 2, "c d": 3, "e": 12}
    with pytest.raises(InvalidScenarioError, match="the program has no parameter 'f'") as caught:
        folder.load(params={"f": 1})
    assert caught.value.code == "SC603"
    extra = scenic.scenarioFromFile(folder.path / "main.scenic", params={"f": 1})
    assert params(extra)["f"] == 1


def test_parameters_that_are_only_read_can_be_given(folder: Any) -> None:
    folder.write(main="param y = globalParameters.x + 1\n")
    assert params(folder.load(params={"x": 2})) == {"y": 3, "x": 2}
    with pytest.raises(InvalidScenarioError, match="no global parameter 'x'"):
        folder.load()


def test_parameters_are_a_read_only_mapping() -> None:
    found = params(
        scenic.scenarioFromString(
            "param a = 1, b = 2\nparam c = ('a' in globalParameters, 'z' in globalParameters, sorted(globalParameters),"
            " len(globalParameters))\n"
        )
    )
    assert found["c"] == (True, False, ["a", "b"], 2)
    given = scenic.scenarioFromString(
        "param a = 1\nparam c = ('b' in globalParameters, sorted(globalParameters), len(globalParameters))\n",
        params={"a": 5, "b": 2},
    )
    assert params(given) == {"a": 5, "b": 2, "c": (True, ["a", "b"], 2)}
    for statement in ("globalParameters.a = 1", "globalParameters = 3", "globalParameters['a'] = 1"):
        with pytest.raises((Located, TypeError)):
            scenic.scenarioFromString(f"param a = 0\n{statement}\n")


# Modules and models


def test_imports_merge_into_the_program(folder: Any) -> None:
    folder.write(
        main="import parts\nfrom parts import Chair, distance_of\nnew Chair at (Range(5, 6), 0)\nparam d = distance_of(ego), n = parts.count\n",
        parts=(
            "class Chair:\n    width: 2\ndef distance_of(x): return distance from x to (0, 0)\ncount = 3\nparam p = Range(0, 1)\n"
            "ego = new Chair at (Range(1, 2), 0)\nworkspace = Workspace(CircularRegion((0, 0), 20))\nrequire ego.x > 1.5\n"
        ),
    )
    for scene in folder.load().sample(20, seed=0):
        assert [type(item).__name__ for item in scene.objects] == ["Chair", "Chair"]
        assert scene.egoObject.x > 1.5
        assert scene.params["d"] == pytest.approx(scene.egoObject.x)
        assert scene.params["n"] == 3
        assert 0 < scene.params["p"] < 1
    assert repr(folder.load().workspace.region) == "CircularRegion(Vector(0, 0, 0), 20)"


def test_the_importer_keeps_its_own_ego_and_workspace(folder: Any) -> None:
    folder.write(
        main="ego = new Object at (9, 9)\nworkspace = Workspace(everywhere)\nimport parts\n",
        parts="ego = new Object\nworkspace = Workspace(CircularRegion((0, 0), 20))\n",
    )
    program = folder.load()
    assert tuple(program.egoObject.position) == (9, 9, 0)
    assert repr(program.workspace.region) == "everywhere"
    assert len(program.objects) == 2


def test_modules_run_once_a_compilation_and_afresh_in_the_next(folder: Any) -> None:
    folder.write(
        main="import a\nimport b\nparam same = a.parts is b.parts, n = len(a.parts.log)\n",
        a="import parts\nparts.log.append(1)\n",
        b="import parts\nparts.log.append(2)\n",
        parts="log = []\n",
    )
    for _ in range(2):
        assert params(folder.load()) == {"same": True, "n": 2}


def test_python_modules(folder: Any) -> None:
    folder.write(
        main="import math, os.path\nfrom math import pi\nparam x = math.floor(pi), y = os.path.basename('a/b')\n"
    )
    assert params(folder.load()) == {"x": 3, "y": "b"}


def test_errors_in_modules_have_their_file(folder: Any) -> None:
    folder.write(main="import parts\n", parts="x = 1\nego = new Object with width 0\n")
    with pytest.raises(Located) as caught:
        folder.load()
    assert caught.value.filename == str(folder.path / "parts.scenic")
    assert caught.value.line == 2
    # Only the specifier is meant; and the text that was given is not that of the file.
    assert caught.value.span == Span(2, 17, 2, 29)
    assert caught.value.program is None
    text = "y = 1\nego = new Object with width 0\n"
    folder.write(alone=text)
    with pytest.raises(Located) as caught:
        folder.load("alone")
    assert (caught.value.span, caught.value.program) == (Span(2, 17, 2, 29), text)
    folder.write(parts="x = = 1\n")
    with pytest.raises(ScenicSyntaxError) as syntax:
        folder.load()
    assert syntax.value.filename == str(folder.path / "parts.scenic")
    assert syntax.value.line == 1


def test_errors_of_requirements_in_modules_have_their_file(folder: Any) -> None:
    folder.write(main="import parts\n", parts="x = Range(0, 1)\nrequire 1 / 0 > x\n")
    with pytest.raises(ZeroDivisionError) as caught:
        folder.load().sample(1, seed=0)
    assert caught.value.__notes__[0].startswith(f"{folder.path / 'parts.scenic'}:2:1: ")


def test_models(folder: Any) -> None:
    folder.write(
        main="param time = 10\nmodel world\nego = new Car\nparam x = (globalParameters.time, globalParameters.rain, _hidden())\ndef _hidden(): return 1\n".replace(
            "param x = (globalParameters.time, globalParameters.rain, _hidden())\ndef _hidden(): return 1\n",
            "param x = (globalParameters.time, globalParameters.rain)\n",
        ),
        world="param time = 12, rain = 0.5\nclass Car:\n    width: 2\n_private = 3\n",
        other="param rain = 0.75\nclass Car:\n    width: 5\n",
    )
    program = folder.load()
    assert params(program)["x"] == (10, 0.5)
    assert program.egoObject.width == 2
    changed = folder.load(model="other")
    assert params(changed)["x"] == (10, 0.75)
    assert changed.egoObject.width == 5
    assert params(folder.load(params={"rain": 1}))["x"] == (10, 1)


@pytest.mark.parametrize(
    ("main", "world", "message"),
    [
        ("model nothing_there\n", "", "there is no world model 'nothing_there'"),
        ("model world\n", "model main\n", "a model cannot itself use `model`"),
        ("model world\nx = _private\n", "_private = 1\n", "_private"),
        ("model world\nx = hidden\n", "__all__ = ['shown']\nshown = 1\nhidden = 2\n", "hidden"),
    ],
)
def test_what_models_cannot_do(folder: Any, main: str, world: str, message: str) -> None:
    folder.write(main=main, world=world)
    with pytest.raises((Located, NameError), match=message):
        folder.load()


# The choice of a scenario


@pytest.mark.parametrize(
    ("text", "chosen", "expected"),
    [
        ("param who = 'module'\n", None, "module"),
        (
            "scenario Main():\n    param who = 'Main'\nscenario Other():\n    param who = 'Other'\n",
            None,
            "Main",
        ),
        (
            "scenario Main():\n    param who = 'Main'\nscenario Other():\n    param who = 'Other'\n",
            "Other",
            "Other",
        ),
        ("scenario Only():\n    setup:\n        param who = 'Only'\n", None, "Only"),
        ("param who = 'module'\nscenario Only(x):\n    param who = x\n", None, "module"),
        ("scenario Only(x='default'):\n    param who = x\n", None, "default"),
        ("name = 'inherited'\nscenario Main():\n    param who = name\n", None, "inherited"),
    ],
)
def test_which_scenario_is_meant(text: str, chosen: str | None, expected: str) -> None:
    assert params(scenic.scenarioFromString(text, scenario=chosen))["who"] == expected


@pytest.mark.parametrize(
    ("text", "chosen", "message"),
    [
        ("scenario A():\n    x = 1\nscenario B():\n    x = 1\n", None, "defines 2 scenarios: A, B"),
        ("scenario Main(x):\n    y = 1\n", None, "scenario 'Main' needs arguments: x"),
        ("scenario A(x):\n    y = 1\n", "A", "scenario 'A' needs arguments: x"),
        ("scenario Alpha():\n    x = 1\n", "Alpa", "there is no scenario 'Alpa'"),
        ("x = 1\n", "A", "there is no scenario 'A'"),
    ],
)
def test_scenarios_that_cannot_be_chosen(text: str, chosen: str | None, message: str) -> None:
    with pytest.raises(ScenarioChoiceError, match=message) as caught:
        scenic.scenarioFromString(text, scenario=chosen)
    assert isinstance(caught.value, RuntimeError)
    assert caught.value.help


def test_a_chosen_scenario_has_what_the_module_made() -> None:
    program = scenic.scenarioFromString(
        "ego = new Object at (Range(0, 1), 0)\nparam a = 1\nrequire ego.x > 0.5\n"
        "scenario Main():\n    setup:\n        new Object left of ego by 3\n        param b = ego.x\n"
    )
    for scene in program.sample(10, seed=0):
        assert scene.egoObject.x > 0.5
        assert scene.params == {"a": 1, "b": scene.egoObject.x}
        assert len(scene.objects) == 2


def test_scenarios_of_imported_modules_do_not_count(folder: Any) -> None:
    folder.write(
        main="from parts import A\nparam who = 'module'\n", parts="scenario A():\n    param who = 'A'\n"
    )
    assert params(folder.load()) == {"who": "module"}


# Several at once, and after mistakes


def test_a_failed_program_leaves_nothing_behind() -> None:
    for text in ("x = = 1", "ego = new Object with width 0", "raise ValueError('x')", "require 1 / 0 > 0"):
        with pytest.raises(Exception, match=r".+"):
            scenic.scenarioFromString(text).sample(1, seed=0)
        assert params(scenic.scenarioFromString("ego = new Object\nparam x = 1")) == {"x": 1}


def test_scenarios_side_by_side() -> None:
    first = scenic.scenarioFromString("x = Range(0, 1)\ndef f(): return x\nrequire f() < 0.5\nparam x = x")
    second = scenic.scenarioFromString("x = Range(5, 6)\ndef f(): return x\nrequire f() > 5.5\nparam x = x")
    streams = zip(first.stream(20, seed=0, lanes=8), second.stream(20, seed=0, lanes=8), strict=True)
    for low, high in streams:
        assert low.params["x"] < 0.5
        assert high.params["x"] > 5.5


def test_deep_check(folder: Any) -> None:
    folder.write(main="ego = new Object\n")
    assert deep_check(folder.path / "main.scenic") == ()
    folder.write(main="x = Range(0, 1)\nrequire x > 2\n")
    assert [item.code for item in deep_check(folder.path / "main.scenic")] == ["SC700"]
    folder.write(main="ego = new Object with width 0\n")
    assert [item.code for item in deep_check(folder.path / "main.scenic")] == ["SC405"]
    folder.write(main="x = 1 / 0\n")
    (found,) = deep_check(folder.path / "main.scenic")
    assert (found.code, found.span is not None and found.span.line) == ("SC400", 1)


@pytest.mark.parametrize(
    ("parameters", "runs"),
    [
        ("", True),
        ("x=3", True),
        ("*xs", True),
        ("**xs", True),
        ("x=3, *xs, y=4, **more", True),
        ("x", False),
        ("*, x", False),
    ],
)
def test_the_only_scenario_runs_unless_it_needs_arguments(parameters: str, runs: bool) -> None:
    """Those that others have defined do not count."""
    text = (
        "param told = 1\n"
        f"scenario Only({parameters}):\n    setup:\n        ego = new Object\n        param told = 2\n"
    )
    made = scenic.scenarioFromString(text)
    assert (made.params["told"], len(made.objects)) == ((2, 1) if runs else (1, 0))


def test_main_runs_if_nobody_chooses() -> None:
    text = "".join(
        f"scenario {name}(x={number}):\n    setup:\n        ego = new Object with width x\n"
        for number, name in enumerate(("First", "Main", "Last"), start=1)
    )
    for chosen, width in ((None, 2), ("First", 1), ("Main", 2), ("Last", 3)):
        assert scenic.scenarioFromString(text, scenario=chosen).objects[0].width == width


def test_objects_have_the_first_name_that_holds_them() -> None:
    text = (
        "a = new Object\nb = a\nrow = [new Object at (5, 0), a, new Object at (9, 0)]\npair = (row[2], row[0])\n"
        "ego = new Object at (0, 9)\nnew Object at (0, 20)\n{}"
    )
    for more, name in (("", "ego"), ("car = ego\n", "car")):
        (scene,) = scenic.scenarioFromString(text.format(more)).sample(1, seed=0)
        assert [scene.names.get(item) for item in scene.objects] == [name, "a", "row[0]", "row[2]", None]


@pytest.mark.parametrize("used", ["param speed = 3", "y = globalParameters.speed"])
def test_parameters_that_a_program_sets_or_reads_may_be_given(tmp_path: Path, used: str) -> None:
    file = tmp_path / "program.scenic"
    file.write_text(f"ego = new Object\n{used}\n")
    assert scenic.load(file, params={"speed": 5}).params["speed"] == 5
    with pytest.raises(InvalidScenarioError, match="no parameter 'sped'"):
        scenic.load(file, params={"speed": 5, "sped": 5})
    found = scenic.scenarioFromFile(file, {"speed": 5, "sped": 6}).params
    assert (found["speed"], found["sped"]) == (5, 6)


OPTIONS = "model first\nparam p = 0\nx = Range(0, 1)\n" + "".join(
    f"scenario {name}():\n    setup:\n        ego = new Object at ({place}, 0, 7)\n        require x > 0.5\n"
    for place, name in enumerate(("Main", "Other"), start=1)
)
CHANGES: dict[str, Any] = {"params": {"p": 5}, "model": "second", "scenario": "Other", "mode2D": True}


def outcome(program: scenic.Scenario) -> dict[str, Any]:
    """What shows which options a program was given."""
    (item,) = program.objects
    return {
        "params": program.params["p"],
        "model": program.params["world"],
        "scenario": item.x,
        "mode2D": item.z == 0,
        "prune": not program.domain.is_whole,
    }


@pytest.mark.parametrize("way", ["load", "scenarioFromFile", "scenarioFromString"])
def test_each_option_reaches_the_program_whichever_way_it_is_loaded(
    way: str, folder: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    import scenic.syntax.translator

    folder.write(main=OPTIONS, first="param world = 'first'", second="param world = 'second'")
    path = folder.path / "main.scenic"

    def made(prune: bool = True, **options: Any) -> dict[str, Any]:
        if way == "load":
            return outcome(scenic.load(path, prune=prune, **options))
        with monkeypatch.context() as changed:
            changed.setattr(scenic.syntax.translator, "usePruning", prune, raising=False)
            if way == "scenarioFromFile":
                return outcome(scenic.scenarioFromFile(str(path), **options))
            return outcome(scenic.scenarioFromString(OPTIONS, filename=str(path), **options))

    usual = {"params": 0, "model": "first", "scenario": 1, "mode2D": False, "prune": True}
    changed = {"params": 5, "model": "second", "scenario": 2, "mode2D": True, "prune": False}
    assert made() == usual
    for name, value in {**CHANGES, "prune": False}.items():
        assert made(**{name: value}) == {**usual, name: changed[name]}
        # And all others, for those that only one of them would reach.
        others = {other: value for other, value in {**CHANGES, "prune": False}.items() if other != name}
        assert made(**others) == {**changed, name: usual[name]}


def test_copies_of_a_scenario_have_its_options(folder: Any) -> None:
    """It is compiled once more where a copy is taken up, with the parameters of then."""
    folder.write(first="param world = 'first'")
    given = {"p": 5, "free": 1}
    made = scenic.scenarioFromString(
        OPTIONS, given, None, "Other", filename=str(folder.path / "main.scenic"), mode2D=True
    )
    given["p"] = 7
    again = pickle.loads(pickle.dumps(made))
    assert outcome(again) == outcome(made)
    assert again.params["free"] == 1
    folder.write(main="param p = 1\nx = Range(0, 1)\nrequire x > 0.5\n")
    for prune in (True, False):
        loaded = folder.load(prune=prune, params={"p": 2})
        copied = pickle.loads(pickle.dumps(loaded))
        assert copied.domain.is_whole is loaded.domain.is_whole is not prune
        assert copied.params["p"] == 2


def test_the_parameters_that_were_given_stay_the_callers_own() -> None:
    given = {"p": [1], "q": 2}
    program = scenic.scenarioFromString("param p = 0, q = 0, r = globalParameters.q\n", given)
    assert given == {"p": [1], "q": 2}
    given["q"] = 3
    assert dict(program.params) == {"p": [1], "q": 2, "r": 2}


def test_deep_checks_name_files_as_they_were_given(folder: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The program's own, relative or not; that of a module in which something is wrong; and all mistakes of a text."""
    folder.write(
        main="x = Range(0, 1)\nrequire x > 2\n",
        two="def f(:\n    pass\nego = new\n",
        user="import broken\n",
        broken="x = 1\ny = x / 0\n",
        strict="workspace = Workspace(CircularRegion((0, 0), 5))\nego = new Object at (Range(20, 30), 0)\n",
    )
    path = folder.path / "main.scenic"
    assert [found.filename for found in deep_check(path)] == [str(path)]
    monkeypatch.chdir(folder.path.parent)
    assert [found.filename for found in deep_check(path.relative_to(Path.cwd()))] == [
        str(path.relative_to(Path.cwd()))
    ]
    assert len(deep_check(folder.path / "two.scenic")) >= 2
    (found,) = deep_check(folder.path / "user.scenic")
    assert found.filename == str(folder.path / "broken.scenic")
    (found,) = deep_check(folder.path / "strict.scenic")
    assert (found.code, found.span is not None and found.span.line) == ("SC700", 2)
    assert "which the language requires" in found.message


def test_deep_checks_tell_what_is_wrong_with_requirements_of_modules_in_their_files(folder: Any) -> None:
    """Those that never hold, that always do, and that contradict others; what is marked in another file has its name."""
    folder.write(
        part="x = Range(0, 1)\n\n\n\nrequire x > 0.5\nrequire x > -1\n",
        never="x = Range(0, 1)\nrequire x > 2\n",
        main="from part import x\nego = new Object\nrequire x < 0.3\n",
        other="import never\nego = new Object\nrequire ego.x > 3\n",
        upper="y = Range(0, 10)\n\nrequire y < 2\n",
        lower="x = Range(0, 10)\nrequire x > 6\n",
        all="from upper import y\nfrom lower import x\nz = Range(0, 10)\nego = new Object\n"
        "require z < 1\nrequire x < y + z\n",
    )
    files = {path.stem: str(path) for path in folder.path.glob("*.scenic")}

    def told(name: str) -> list[Any]:
        return [
            (
                item.code,
                item.filename,
                item.span and item.span.line,
                [(label.span.line, label.filename) for label in item.labels],
            )
            for item in deep_check(files[name])
        ]

    assert told("main") == [
        ("SC700", files["part"], 5, [(3, files["main"])]),
        ("SC701", files["part"], 6, []),
    ]
    assert told("other") == [
        ("SC700", files["never"], 2, [(1, None)]),
        ("SC700", files["other"], 3, []),
    ]
    # First what is marked in the file itself.
    assert told("all") == [("SC700", files["all"], 6, [(5, None), (2, files["lower"]), (3, files["upper"])])]


def test_where_an_exception_was_raised_is_shown_beside_the_line_that_led_there(folder: Any) -> None:
    """In another line, or in another file at the same one; not within the statement itself, of however many lines."""
    (folder.path / "plain.py").write_text("def fail(v):\n    raise KeyError(v)\n")
    folder.write(
        python="from plain import fail\nfail(1)\n",
        far="from plain import fail\n\n\nfail(1)\n",
        code="def f(v):\n    return v / 0\nx = Range(0, 1)\nrequire f(x)\n",
        within="x = Range(0, 1)\n\nrequire max(\n    1,\n    (lambda v: v / 0)(x),\n) > 0\n",
    )
    found = {}
    for name in ("python", "far", "code", "within"):
        with pytest.raises((KeyError, ZeroDivisionError)) as caught:
            folder.load(name).sample(1, seed=1)
        told = diagnose(caught.value)
        assert told is not None
        assert told.span is not None
        labels = [(label.span.line, label.filename and Path(label.filename).name) for label in told.labels]
        found[name] = told.span.line, labels
    assert found == {
        "python": (2, [(2, "plain.py")]),
        "far": (4, [(2, "plain.py")]),
        "code": (4, [(2, "code.scenic")]),
        "within": (3, []),
    }


def test_modules_beside_a_program_come_before_those_elsewhere(
    folder: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = folder.path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "part.scenic").write_text("param told = 'elsewhere'\n")
    (elsewhere / "only.scenic").write_text("param other = 'elsewhere'\n")
    monkeypatch.syspath_prepend(elsewhere)
    folder.write(part="param told = 'beside'\n", main="import part\nimport only\n")
    assert dict(folder.load().params) == {"told": "beside", "other": "elsewhere"}


def test_regions_of_a_scene_are_those_of_public_variables() -> None:
    text = (
        "a = CircularRegion((0, 0), 1)\n_hidden = CircularRegion((0, 0), 2)\nb = everywhere\nc = nowhere\n"
        "workspace = Workspace(CircularRegion((0, 0), 50))\nd = workspace\ne = Uniform(a, _hidden)\nego = new Object\n"
    )
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=0)
    assert "a" in scene.regions
    assert not {"_hidden", "b", "c", "d", "workspace"} & set(scene.regions)


def test_a_program_may_be_loaded_while_another_one_is() -> None:
    """By code that it calls: afterwards it goes on as itself."""
    text = (
        "import scenic\nx = Range(0, 1)\nnew Object at (x, 0)\n"
        "inner = scenic.scenarioFromString('new Object\\nnew Object at (5, 5)\\nparam p = 1')\n"
        "y = Range(5, 6)\nnew Object at (0, y)\nparam q = len(inner.objects)\n"
        "@distributionFunction\ndef twice(v): return 2 * v\nparam twice = twice(y), place = localPath('x').name\n"
        "class Post:\n    height: y\nparam post = (new Post at (50, 50)).height\n"
    )
    program = scenic.scenarioFromString(text)
    assert len(program.objects) == 3
    (scene,) = program.sample(1, seed=1)
    y = scene.objects[1].y
    assert 5 <= y <= 6
    assert scene.params == {"q": 2, "twice": 2 * y, "place": "x", "post": y}
