"""Imports between Scenic modules, of Python modules beside the program, and models."""

import importlib
import sys
from pathlib import Path

import pytest

import scenic
from scenic.failures import diagnose
from scenic.language.errors import InvalidScenarioError
from scenic.simulators.dummy import DummySimulator


def written(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return folder / "main.scenic"


def first(path: Path) -> scenic.Scene:
    (scene,) = scenic.scenarioFromFile(path).sample(1, seed=0)
    return scene


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)


def test_python_modules_beside_the_program_are_found_from_anywhere(tmp_path: Path) -> None:
    main = written(
        tmp_path,
        {
            "helper_one.py": "import helper_two\ndef f(x): return x + helper_two.g()\n",
            "helper_two.py": "def g(): return 5\n",
            "main.scenic": "from helper_one import f\ndef late():\n    import helper_two\n    return helper_two.g()\n"
            "ego = new Object at (f(1), 0)\nrequire late() == 5\n",
        },
    )
    before = list(sys.path)
    assert first(main).egoObject.position.x == 6
    assert sys.path == before
    loaded = sys.modules["helper_one"]
    assert first(main).egoObject.position.x == 6
    assert sys.modules["helper_one"] is loaded
    main.write_text(f"{main.read_text()}raise KeyError('x')\n")
    with pytest.raises(KeyError):
        first(main)
    assert sys.path == before


def test_methods_are_the_programs_through_any_decorator_of_a_library(tmp_path: Path) -> None:
    """What else the decorator holds, functions of its own among it, hides them as little as other decorators do."""
    main = written(
        tmp_path,
        {
            "library.py": "import functools\ndef plain(x): return x\ndef other(x): return x\n"
            "def marked(function, before=plain, update=other):\n"
            "    def wrapper(*args): return update(function(*map(before, args)))\n    return wrapper\n"
            "def cached(function): return functools.cache(marked(function))\n",
            "main.scenic": "from library import marked, cached\nr = Range(1, 2)\nclass A:\n"
            "    @marked\n    def one(self): return r\n    @marked\n    @marked\n    def two(self): return r\n"
            "    @cached\n    def three(self): return r\n"
            "ego = new A\nparam r = r, found = [ego.one(), ego.two(), ego.three()]\n",
        },
    )
    found = first(main)
    ego, r = found.objects[0], found.params["r"]
    assert 1 < r < 2
    assert [*found.params["found"], ego.one(), ego.two(), ego.three()] == [r] * 6


def test_what_a_package_defines_comes_before_its_modules(tmp_path: Path) -> None:
    main = written(
        tmp_path,
        {
            "pkg/__init__.scenic": "foo = 3\n",
            "pkg/foo.scenic": "x = 4\n",
            "pkg/bar.scenic": "x = 5\n",
            "main.scenic": "from pkg import foo, bar\nego = new Object\nparam foo = foo, bar = bar.x\n",
        },
    )
    assert first(main).params == {"foo": 3, "bar": 5}


def test_what_a_program_adds_to_the_search_path_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = ["folder", *sys.path]
    monkeypatch.setattr(sys, "path", before[1:])
    main = written(tmp_path, {"main.scenic": "import sys\nsys.path.insert(0, 'folder')\nego = new Object\n"})
    first(main)
    assert sys.path == before


def test_modules_of_one_program_are_not_those_of_another(tmp_path: Path) -> None:
    for name, value in (("a", 1), ("b", 2)):
        written(
            tmp_path / name,
            {
                "same_name.py": f"VALUE = {value}\n",
                "main.scenic": "import same_name\nparam x = same_name.VALUE\n",
            },
        )
    found = [first(tmp_path / name / "main.scenic").params["x"] for name in "abab"]
    assert found == [1, 2, 1, 2]


def test_a_module_beside_the_program_comes_before_one_on_the_path_of_python(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(tmp_path / "usual", {"own_first.py": "VALUE = 1\n"})
    monkeypatch.syspath_prepend(str(tmp_path / "usual"))
    main = written(
        tmp_path / "own",
        {"own_first.py": "VALUE = 2\n", "main.scenic": "import own_first\nparam x = own_first.VALUE\n"},
    )
    assert first(main).params["x"] == 2


def test_packages_of_one_program_are_not_those_of_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With all their parts, and without others whose names only begin alike."""
    written(tmp_path / "usual", {"same_package_too.py": ""})
    monkeypatch.syspath_prepend(str(tmp_path / "usual"))
    usual = importlib.import_module("same_package_too")
    for name, value in (("a", 1), ("b", 2)):
        written(
            tmp_path / name,
            {
                "same_package/__init__.py": "",
                "same_package/part.py": f"VALUE = {value}\n",
                "main.scenic": "from same_package.part import VALUE\nparam x = VALUE\n",
            },
        )
    found = [first(tmp_path / name / "main.scenic").params["x"] for name in "abab"]
    assert found == [1, 2, 1, 2]
    assert sys.modules["same_package_too"] is usual


def test_modules_on_the_path_of_python_are_loaded_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether or not the program has a file of that name beside it, which then is not looked at."""
    written(tmp_path / "usual", {"usual_name.py": "VALUE = 1\n"})
    monkeypatch.syspath_prepend(str(tmp_path / "usual"))
    usual = importlib.import_module("usual_name")
    main = written(
        tmp_path / "own",
        {"usual_name.py": "VALUE = 2\n", "main.scenic": "import usual_name\nparam x = usual_name.VALUE\n"},
    )
    assert first(main).params["x"] == 1
    assert sys.modules["usual_name"] is usual


PACKAGE = {
    "pkg/a.scenic": "K = 7\nnew Object at (20, 20)\nparam from_a = 1\n",
    "pkg/b.scenic": "from .a import K\nfrom . import a\nB = K + a.K\n",
    "pkg/deep/c.scenic": "from ..a import K\nC = 2 * K\n",
    "pkg/deep/down/d.scenic": "from ...a import K\nfrom ..c import C\nfrom ... import a\nfrom .. import c\nD = K + C + a.K - c.C\n",
    "pkg/whole/__init__.scenic": "from .part import P\nfrom ..a import K\nfrom . import part\nW = part.P * P + K - 1\n",
    "pkg/whole/part.scenic": "P = 1\n",
}


@pytest.mark.parametrize(
    "statement",
    [
        "import pkg.a\nx = pkg.a.K",
        "import pkg.a as m\nx = m.K",
        "from pkg.a import K as x",
        "from pkg.a import *\nx = K",
        "from pkg import a\nx = a.K",
        "from pkg import b, a\nx = b.B / 2",
        "from pkg.deep import c\nx = c.C / 2",
        "from pkg.deep.down.d import D\nx = D / 2",
        "import pkg.deep.down.d\nx = pkg.deep.down.d.D / 2",
        "from pkg.whole import W as x",
        "from pkg import whole\nx = whole.W",
        "import pkg.a\nimport pkg.deep.c\nimport pkg.deep.down.d\nx = pkg.a.K * pkg.deep.c.C / pkg.deep.down.d.D",
        "import pkg.whole\nimport pkg.whole.part\nx = pkg.whole.W * pkg.whole.part.P",
        "import pkg.whole.part\nx = pkg.whole.W * pkg.whole.part.P",
    ],
)
def test_scenic_modules_in_packages(tmp_path: Path, statement: str) -> None:
    main = written(tmp_path, {**PACKAGE, "main.scenic": f"{statement}\nparam x = x\nego = new Object\n"})
    scene = first(main)
    assert scene.params == {"from_a": 1, "x": 7}
    assert len(scene.objects) == 2


@pytest.mark.parametrize(
    "imports",
    [
        "import mixed.a\nimport mixed.tool",
        "import mixed.tool\nimport mixed.a",
        "import mixed.tool\nimport mixed.deep.b\nimport mixed.a",
        "import mixed.a\nimport mixed.deep.b\nimport mixed.tool\nimport mixed.deep.rule\nimport mixed",
    ],
)
def test_a_package_leads_to_modules_of_scenic_and_of_python(tmp_path: Path, imports: str) -> None:
    files = {
        "mixed/__init__.py": "SCALE = 10\n",
        "mixed/tool.py": "def twice(x):\n    return x * 2\n",
        "mixed/deep/rule.py": "OFFSET = 1\n",
        "mixed/deep/b.scenic": "B = Range(1, 2)\n",
        "mixed/a.scenic": "import mixed.deep.b\nA = Range(1, 2)\n",
        "main.scenic": f"""{imports}
def f(x):
    return mixed.tool.twice(x) if x == mixed.a.A else -1
ego = new Object
param a = mixed.a.A, twice = mixed.tool.twice(mixed.a.A), scale = mixed.SCALE
require f(mixed.a.A) > 3
if hasattr(mixed, "deep"):
    param rule = getattr(mixed.deep, "rule", None)
try:
    mixed.tol
except AttributeError as error:
    param message = str(error)
""",
    }
    found = first(written(tmp_path, files)).params
    assert found["a"] > 1.5
    assert (found["twice"], found["scale"]) == (2 * found["a"], 10)
    if "deep" in imports:
        assert getattr(found["rule"], "OFFSET", None) == (1 if "rule" in imports else None)
    assert "module 'mixed' has no attribute 'tol'" in found["message"]


def test_the_importer_takes_the_ego_unless_it_has_one(tmp_path: Path) -> None:
    module = "ego = new Object at (3, 3)\nworkspace = Workspace(CircularRegion((0, 0), 9))\n"
    main = written(tmp_path, {"m.scenic": module, "main.scenic": "import m\n"})
    assert first(main).egoObject.position.x == 3
    main = written(tmp_path, {"main.scenic": "ego = new Object\nimport m\n"})
    assert first(main).egoObject.position.x == 0


def test_models_give_names_and_defaults_of_parameters(tmp_path: Path) -> None:
    files = {
        "world.scenic": "param a = 1, b = 2\nclass Thing:\n    size: 3\n_hidden = 4\n",
        "main.scenic": "param a = 5\nmodel world\nparam x = new Thing\nparam y = '_hidden' in globals()\n",
    }
    found = first(written(tmp_path, files)).params
    assert (found["a"], found["b"], found["x"].size, found["y"]) == (5, 2, 3, False)
    main = written(tmp_path, {"other.scenic": "param a = 9, c = 3\nclass Thing:\n    size: 8\n"})
    scenario = scenic.scenarioFromFile(main, model="other")
    assert scenario.sample(1, seed=0)[0].params["x"].size == 8


def test_what_a_model_imports_gives_defaults_of_parameters_too(tmp_path: Path) -> None:
    files = {
        "deeper.scenic": "param a = 8, b = 9\n",
        "world.scenic": "import deeper\nparam b = 2, c = 3\n",
        "main.scenic": "param a = 5\nmodel world\nimport deeper\nparam d = 6\n",
    }
    assert first(written(tmp_path, files)).params == {"a": 5, "b": 9, "c": 3, "d": 6}


@pytest.mark.parametrize("statement", ["from own import *", "model own"])
def test_functions_that_a_module_gives_count_whatever_their_names_usually_mean(
    tmp_path: Path, statement: str
) -> None:
    """Also in conditions, where those of Python are understood without being called."""
    files = {
        "own.scenic": "def max(*values): return min(values)\ndef abs(value): return -value\n",
        "main.scenic": f"{statement}\nx = Range(0, 1)\nrequire abs(x) < -0.5\nrequire max(x, 0.8) < 0.8\nparam x = x\n",
    }
    main = written(tmp_path, files)
    values = [scene.params["x"] for scene in scenic.scenarioFromFile(main).sample(60, seed=0)]
    assert 0.5 < min(values) < 0.55
    assert 0.75 < max(values) < 0.8


def test_a_missing_model_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InvalidScenarioError, match="no world model"):
        first(written(tmp_path, {"main.scenic": "model nothing_here\n"}))


def test_a_missing_file_is_a_file_not_found_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        scenic.scenarioFromFile(tmp_path / "nothing.scenic")


def test_errors_tell_their_line_and_text(tmp_path: Path) -> None:
    for load in (
        lambda text: scenic.scenarioFromString(text),
        lambda text: scenic.scenarioFromFile(written(tmp_path, {"main.scenic": text})),
    ):
        with pytest.raises(scenic.ScenicSyntaxError) as caught:
            load("ego = new Object\nx = = 3\n")
        error = caught.value
        assert (error.lineno, error.offset, error.text) == (2, 5, "x = = 3\n")
        with pytest.raises(scenic.SpecifierError) as located:
            load("ego = new Object at (1, 2), at (3, 4)\n")
        assert located.value.lineno == 1
        assert located.value.text == "ego = new Object at (1, 2), at (3, 4)\n"


def test_names_of_python_and_of_scenic_come_from_one_package(tmp_path: Path) -> None:
    """Of a folder that is a package of Python's and has Scenic modules, too."""
    main = written(
        tmp_path,
        {
            "mixed/__init__.py": "VALUE = 3\n",
            "mixed/helper.py": "def double(x): return 2 * x\n",
            "mixed/a.scenic": "from . import VALUE\nfrom .helper import double\nK = double(VALUE) + 1\n",
            "main.scenic": "from mixed import a, VALUE, helper\nfrom mixed import helper as other, a as b\n"
            "param x = (a.K, VALUE, helper.double(2), other.double(3), b.K)\n",
        },
    )
    assert first(main).params["x"] == (7, 3, 4, 6, 7)


@pytest.mark.parametrize("error", ["ScenicValueError('bad')", "ValueError('bad')"])
def test_a_failing_requirement_is_shown_in_the_module_that_it_is_in(tmp_path: Path, error: str) -> None:
    """Whatever kind of error comes up on a sample."""
    files = {
        "module.scenic": "from helper import fail\nx = Range(0, 1)\n\nrequire fail(x)\n",
        "helper.py": f"from scenic.language.errors import ScenicValueError\ndef fail(x): raise {error}\n",
        "main.scenic": "import module\nego = new Object\n",
    }
    with pytest.raises(ValueError, match="bad") as caught:
        first(written(tmp_path, files))
    found = diagnose(caught.value)
    assert found is not None
    assert found.span is not None
    assert (found.filename, found.span.line) == (str(tmp_path / "module.scenic"), 4)


def test_packages_on_the_path_of_python_are_loaded_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As single modules are: their classes are the same for every program, whatever lies beside it."""
    files = {"usual_package/__init__.py": "class A: pass\n", "usual_package/part.py": "class B: pass\n"}
    written(tmp_path / "usual", files)
    monkeypatch.syspath_prepend(str(tmp_path / "usual"))
    part = importlib.import_module("usual_package.part")
    main = written(
        tmp_path / "own",
        {
            "usual_package/__init__.py": "",
            "usual_package/part.py": "B = None\n",
            "main.scenic": "from usual_package.part import B\nimport usual_package\nparam x = [B, usual_package.A]\n",
        },
    )
    assert first(main).params["x"] == [part.B, sys.modules["usual_package"].A]
    assert sys.modules["usual_package.part"] is part


@pytest.mark.parametrize("module", ["numbers_of", "some.numbers_of", "some.more.numbers_of"])
@pytest.mark.parametrize("name", ["x", "_x"])
def test_random_values_of_a_module_that_a_function_looks_into(tmp_path: Path, module: str, name: str) -> None:
    main = written(
        tmp_path,
        {
            f"{module.replace('.', '/')}.scenic": f"{name} = Range(0, 1)\n",
            "main.scenic": f"import {module}\n"
            "def low():\n"
            f"    if {module}.{name} < 0.3:\n"
            "        return True\n"
            f"    return {module}.{name} < 0.4\n"
            f"require low()\nparam x = {module}.{name}\n",
        },
    )
    values = [scene.params["x"] for scene in scenic.scenarioFromFile(main).sample(50, seed=1)]
    assert 0.3 < max(values) < 0.4
    assert len(set(values)) == len(values)


def test_modules_of_one_package_are_all_found_by_its_name(tmp_path: Path) -> None:
    files = {"pkg/c.scenic": "K = 8\n", "pkg/deep/e.scenic": "K = 9\n"}
    for statements in ("import pkg.a\nimport pkg.c", "import pkg.c, pkg.a"):
        text = f"{statements}\nimport pkg.deep.e, pkg.deep.c\nparam x = (pkg.a.K, pkg.c.K, pkg.deep.e.K, pkg.deep.c.C)\nego = new Object\n"
        assert first(written(tmp_path, {**PACKAGE, **files, "main.scenic": text})).params["x"] == (
            7,
            8,
            9,
            14,
        )
    text = "import pkg.whole\nimport pkg.whole.part\nparam x = (pkg.whole.W, pkg.whole.part.P)\nego = new Object\n"
    assert first(written(tmp_path, {**PACKAGE, "main.scenic": text})).params["x"] == (7, 1)


def test_import_as_a_function_takes_its_arguments_by_name(tmp_path: Path) -> None:
    text = 'param x = __import__("os.path", fromlist=["join"]).basename("a/b")\nego = new Object\n'
    assert first(written(tmp_path, {"main.scenic": text})).params["x"] == "b"


def test_what_is_imported_within_a_function_is_sampled(tmp_path: Path) -> None:
    text = """
import lib as unused
def small():
    def inner():
        import lib
        return lib.r < 1.5
    return inner()
require small()
param r = unused.r
ego = new Object
"""
    main = written(tmp_path, {"lib.scenic": COUNTING, "main.scenic": text})
    scenes = scenic.scenarioFromFile(main).sample(4, seed=0)
    assert all(1 < scene.params["r"] < 1.5 for scene in scenes)


COUNTING = """
count = 0
items = []
r = Range(1, 2)
def more():
    global count
    count += 1
    items.append(count)
    return count
behavior Jump():
    global count
    count += 100
    take count
"""


@pytest.mark.parametrize(
    "statement",
    ["import pkg.lib as lib", "from pkg import lib", "import pkg.lib\nlib = pkg.lib"],
    ids=["as", "from", "name"],
)
def test_what_functions_read_of_modules_in_packages_is_sampled(tmp_path: Path, statement: str) -> None:
    way = "pkg.lib" if statement.startswith("import pkg.lib\n") else "lib"
    text = f"{statement}\ndef small(): return {way}.r < 1.5\nrequire small()\nparam r = lib.r\nego = new Object\n"
    main = written(tmp_path, {"pkg/lib.scenic": COUNTING, "main.scenic": text})
    scenes = scenic.scenarioFromFile(main).sample(8, seed=0)
    assert all(1 < scene.params["r"] < 1.5 for scene in scenes)
    assert len({scene.params["r"] for scene in scenes}) == 8


@pytest.mark.parametrize(
    ("top", "within"),
    [
        ("import lib", "pass"),
        ("import pkg.lib", "lib = pkg.lib"),
        ("import lib", "import lib as mine\n    lib.r"),
        ("import lib as unused", "import lib"),
        ("import pkg.lib", "import pkg.lib as lib"),
        ("", "import lib"),
        ("", "import pkg.lib\n    lib = pkg.lib"),
        ("", "from pkg import lib"),
    ],
)
def test_each_simulation_has_one_copy_of_each_module(tmp_path: Path, top: str, within: str) -> None:
    """Whether its names are asked of the module or of its functions, and wherever it is imported."""
    text = f"""
{top}
behavior B():
    {within}
    for _ in range(2):
        lib.more()
        take lib.count, list(lib.items), lib.more(), lib.r
        lib.count += 10
    do lib.Jump()
    take lib.count, lib.more()
ego = new Object with behavior B
"""
    main = written(tmp_path, {"lib.scenic": COUNTING, "pkg/lib.scenic": COUNTING, "main.scenic": text})
    for scene in scenic.scenarioFromFile(main).sample(2, seed=0):
        drawn = []
        for key in (b"1", b"1", b"2"):
            done = DummySimulator().simulate(scene, maxSteps=4, key=key)
            assert done is not None
            assert done.result is not None
            first_one, second, *jump = (step[scene.egoObject] for step in done.result.actions)
            assert jump == [(124,), (124, 125)]
            assert first_one[:3] == (1, [1], 2)
            assert second[:3] == (13, [1, 2, 13], 14)
            assert first_one[3] == second[3]
            drawn.append(first_one[3])
        assert 1 < drawn[0] < 2
        # What only the simulation imports is drawn within it, by its key; all else with the scene.
        assert len(set(drawn)) == (1 if top else 2)
        assert drawn[0] == drawn[1]


@pytest.mark.parametrize(
    ("public", "names"),
    [
        ("", ["y", "z"]),
        ("__all__ = ['_x', 'y']\n", ["_x", "y"]),
        ("__all__ = []\n", []),
        ("__all__ = ('z',)\n", ["z"]),
    ],
)
def test_models_give_what_they_say_is_public(tmp_path: Path, public: str, names: list[str]) -> None:
    files = {
        "world.scenic": f"_x = 3\ny = 4\nz = 5\n{public}",
        "main.scenic": "model world\nparam found = [name for name in ('_x', 'y', 'z') if name in globals()]\n",
    }
    assert first(written(tmp_path, files)).params["found"] == names


@pytest.mark.parametrize(
    "own", ["", "ego = new Object\n", "workspace = Workspace(CircularRegion((0, 0), 9))\n"]
)
@pytest.mark.parametrize("statement", ["import m", "from m import unused", "model m"])
def test_of_ego_and_workspace_each_is_taken_by_itself(tmp_path: Path, own: str, statement: str) -> None:
    module = "ego = new Object at (90, 90), with regionContainedIn everywhere\nworkspace = Workspace(CircularRegion((50, 50), 5))\nunused = 3\n"
    use = "param ego = ego, item = new Object in workspace, with requireVisible False\n"
    before = own.replace("new Object", "new Object with regionContainedIn everywhere")
    found = first(written(tmp_path, {"m.scenic": module, "main.scenic": f"{before}{statement}\n{use}"}))
    assert (found.params["ego"].x == 0) == ("ego" in own)
    assert (found.params["item"].x < 20) == ("workspace" in own)
    assert found.egoObject is found.params["ego"]


@pytest.mark.parametrize("given", [{}, {"a": 9}, {"a": 9, "b": 8, "c": 7}])
def test_parameters_that_are_given_come_before_all_others(tmp_path: Path, given: dict[str, int]) -> None:
    """Before those of the program and of its model, whichever statement is first, and wherever they are read."""
    files = {
        "world.scenic": "param a = 1, b = 2, c = 3\nseen = globalParameters.a\n",
        "main.scenic": "model world\nparam b = 5\nparam seen = (seen, globalParameters.a, globalParameters.b, globalParameters['c'])\nparam c = 6\nego = new Object\n",
    }
    scenario = scenic.scenarioFromFile(written(tmp_path, files), params=given)
    params = dict(scenario.sample(1, seed=0)[0].params)
    usual = {"a": 1, "b": 5, "c": 6}
    a, b = given.get("a", 1), given.get("b", 5)
    assert params.pop("seen") == (a, a, b, given.get("c", 3))
    assert params == {**usual, **given}


def test_a_module_may_have_others_below_it(tmp_path: Path) -> None:
    files = {
        "p/q.scenic": "k = Range(0, 1)\n",
        "p/q/a.scenic": "z = Range(2, 3)\n",
        "main.scenic": "import p.q\nimport p.q.a\ndef low(): return p.q.k < 0.5 and p.q.a.z < 2.5\n"
        "require low()\nparam found = (p.q.k, p.q.a.z)\nego = new Object\n",
    }
    k, z = first(written(tmp_path, files)).params["found"]
    assert k < 0.5
    assert 2 < z < 2.5


def test_what_is_mutated_is_so_whatever_is_imported(tmp_path: Path) -> None:
    text = (
        "{}a = new Object at (0, 0)\nego = new Object at (90, 90)\n{}c = Uniform(a, a)\nx = c.position.x\n{}mutate a\n"
        "param c = c, x = x, a = a\n"
    )
    for place in range(3):
        imports = ["import m\n" if place == number else "" for number in range(3)]
        found = first(written(tmp_path, {"m.scenic": "k = 1\n", "main.scenic": text.format(*imports)}))
        a = found.params["a"]
        assert found.params["c"] is a
        assert found.params["x"] == a.x != 0


@pytest.mark.parametrize(
    ("made", "words"),
    [
        ("new Object\nnew Object at (0.5, 0)\n", "always collides"),
        (
            "new Object\nnew Object at (0, 5), with regionContainedIn CircularRegion((0, 0), 1)\n",
            "not inside its container",
        ),
        ("new Object\nnew Object at (0, 5), with requireVisible True\n", "there is no ego"),
        ("watcher = new OrientedPoint\nnew Object at (0, -999), visible from watcher\n", "cannot be seen"),
    ],
)
def test_what_fails_in_every_scene_is_shown_in_the_module_that_makes_it(
    tmp_path: Path, made: str, words: str
) -> None:
    (tmp_path / "making.scenic").write_text(made)
    (tmp_path / "main.scenic").write_text("x = 3\n\n\nimport making\n")
    with pytest.raises(InvalidScenarioError, match=words) as caught:
        scenic.scenarioFromFile(str(tmp_path / "main.scenic"))
    assert caught.value.span is not None
    assert (Path(str(caught.value.filename)).name, caught.value.span.line) == ("making.scenic", 2)


def test_workspaces_of_workspaces_contain_as_their_region_does() -> None:
    text = "space = CircularRegion((0, 0), 3)\nworkspace = Workspace(Workspace(Workspace(space)))\nego = new Object at ({}, 0){}\n"
    for more in ("", ", with regionContainedIn Workspace(Workspace(space))"):
        assert scenic.scenarioFromString(text.format(2, more)).sample(1, seed=0)
        with pytest.raises(InvalidScenarioError, match="not inside its container"):
            scenic.scenarioFromString(text.format(3, more))
        placed = scenic.scenarioFromString(text.format("Range(0, 5)", more)).sample(30, seed=0)
        assert 1.5 < max(each.egoObject.x for each in placed) < 2.5


def test_names_with_an_underscore_are_those_of_the_simulation_too(tmp_path: Path) -> None:
    files = {
        "m.scenic": "_log = []\n_limit = Range(0, 1)\n",
        "main.scenic": "import m\nbehavior B():\n    m._log.append(1)\n    take (m._limit, len(m._log))\n"
        "ego = new Object with behavior B\nparam limit = m._limit\n",
    }
    scene = first(written(tmp_path, files))
    for _ in range(2):
        done = DummySimulator().simulate(scene, maxSteps=1)
        assert done is not None
        assert done.result is not None
        assert list(done.result.actions[0].values()) == [(scene.params["limit"], 1)]
