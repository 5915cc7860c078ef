"""The prelude's second context: during a simulation values are drawn at once and conditions are evaluated in place."""

from collections.abc import Callable
from pathlib import Path
from types import CodeType, ModuleType

import numpy as np
import pytest
from scipy import stats

from scenic.compiler.compile import compile_text
from scenic.language.errors import InvalidScenarioError, RejectionException
from scenic.runtime.description.outcome import Program
from scenic.runtime.ground.context import Context, current
from scenic.runtime.program.prelude import Loader
from scenic.runtime.values.values import Vector
from scenic.simulators.dummy import DummySimulator
from tests.runtime.programs import FALSE_ALARM, draws, params, scene


class NoModules:
    def find(self, name: str) -> Path | None:
        return None

    def code(self, path: Path) -> CodeType:
        raise FileNotFoundError(path)


@pytest.fixture
def run() -> Callable[..., tuple[ModuleType, Program]]:
    def run_text(text: str, seed: int = 0) -> tuple[ModuleType, Program]:
        compiled = compile_text(text, filename="eager.scenic")
        assert compiled.code is not None, compiled.diagnostics
        context = Context(generator=np.random.default_rng(seed))
        program = Program()
        token = current.set(context)
        try:
            module, _ = Loader(NoModules(), context, program).run(compiled.code, "eager.scenic")
        finally:
            current.reset(token)
        return module, program

    return run_text


def test_distributions_give_plain_values(run: Callable[..., tuple[ModuleType, Program]]) -> None:
    module, _ = run(
        "x = Range(2, 3)\nn = DiscreteRange(1, 6)\nc = Uniform('a', 'b')\nb = x > 2.5\nd = sin(x)"
    )
    assert 2 <= module.x <= 3
    assert module.n in range(1, 7)
    assert module.c in ("a", "b")
    assert module.b is (module.x > 2.5)
    assert module.d == pytest.approx(np.sin(module.x))


def test_the_same_specifiers_give_concrete_objects(
    run: Callable[..., tuple[ModuleType, Program]],
) -> None:
    module, program = run(
        "ego = new Object at (Range(0, 1), 0), facing Range(0, 90) deg\n"
        "box = new Object ahead of ego by Range(1, 2), with width Range(1, 3)\n"
        "chosen = Uniform(ego, box)\n"
        "there = front of box\n"
    )
    ego, box = program.objects
    assert isinstance(box.position, Vector)
    gap = (box.position - ego.position).norm() - 1
    assert 1 <= gap <= 2
    assert box.heading == pytest.approx(ego.heading)
    assert module.chosen in (ego, box)
    assert (module.there.position - box.position).norm() == pytest.approx(0.5)


def test_every_run_draws_anew(run: Callable[..., tuple[ModuleType, Program]]) -> None:
    assert run("x = Range(0, 1)", seed=1)[0].x != run("x = Range(0, 1)", seed=2)[0].x
    assert run("x = Range(0, 1)", seed=1)[0].x == run("x = Range(0, 1)", seed=1)[0].x


@pytest.mark.parametrize(
    "region",
    [
        "BoxRegion(dimensions=(2, 2, 2))",
        "SpheroidRegion()",
        "MeshVolumeRegion(mesh=trimesh.creation.cone(1, 2))",
        "BoxRegion(dimensions=(2, 2, 2)).difference(BoxRegion(dimensions=(1, 1, 1)))",
        "CircularRegion((0, 0), 2)",
        "BoxRegion(dimensions=(2, 2, 2)).getSurfaceRegion()",
        "PathRegion([(0, 0, 0), (3, 4, 5)])",
    ],
)
def test_points_of_regions_are_drawn_apart_and_evenly(
    region: str, run: Callable[..., tuple[ModuleType, Program]]
) -> None:
    """None comes twice, and they spread as those of scenes do."""
    module, _ = run(
        f"import trimesh\nr = {region}\nplaces = [tuple((new Point in r).position) for _ in range(60)]"
    )
    assert len(set(module.places)) == 60
    assert all(module.r.containsPoint(place) for place in module.places)
    usual = np.array(draws(f"import trimesh\nparam x = (new Point in {region}).position", n=200))
    for found, expected in zip(np.array(module.places).T, usual.T, strict=True):
        assert np.ptp(expected) == 0 or stats.ks_2samp(found, expected).pvalue > FALSE_ALARM


def test_requirements_are_checked_at_once(run: Callable[..., tuple[ModuleType, Program]]) -> None:
    run("x = Range(0, 1)\nrequire x >= 0 and not x > 1\nrequire (x if x < 2 else 3) < 2")
    with pytest.raises(RejectionException):
        run("x = Range(0, 1)\nrequire x > 1")


def test_soft_requirements_are_enforced_as_often_as_they_say(
    run: Callable[..., tuple[ModuleType, Program]],
) -> None:
    rejected = 0
    for seed in range(200):
        try:
            run("require[0.25] False", seed=seed)
        except RejectionException:
            rejected += 1
    assert 25 <= rejected <= 80  # 50 expected, standard deviation 6.1


def test_parameters_cannot_be_set(run: Callable[..., tuple[ModuleType, Program]]) -> None:
    with pytest.raises(InvalidScenarioError, match="param"):
        run("param p = 1")


def test_the_initial_scenario_is_over(run: Callable[..., tuple[ModuleType, Program]]) -> None:
    assert run("early = initial scenario")[0].early is False


def test_quotients_of_vectors_are_those_of_their_components() -> None:
    """Not products with a reciprocal, which differ in the last bit; alone, in a program, and over lanes."""
    row = (1.0, 3.0, 7.0)
    found = params(
        "n = Uniform(3, 10, 49)\nparam n = n, v = Vector(1, 3, 7) / n, w = [Vector(1, 3, 7) / k for k in (3, 10, 49)]"
    )
    assert tuple(found["v"]) == tuple(part / found["n"] for part in row)
    assert [tuple(value) for value in found["w"]] == [tuple(part / k for part in row) for k in (3, 10, 49)]
    assert tuple(Vector(*row) / 10) == (0.1, 0.3, 0.7)


def test_vectors_equal_rows_of_their_numbers() -> None:
    """A pair stands for one at z = 0."""
    vector, flat = Vector(1, 2, 5), Vector(1, 2, 0)
    assert vector == (1, 2, 5) == vector
    assert vector == [1, 2, 5]
    assert flat == (1, 2)
    assert flat == [1, 2]
    for other in ((1, 2), (1, 2, 4), (1, 3, 5), (1,), (), (1, 2, 5, 0), [1, 2], "125", 1):
        assert vector != other


SPECIFIED = """
at (k, 2)
at (k, 2, 3), facing (0.5, 0.4, 0.3 * k)
at place, facing flow
at place, facing 0.5 * k relative to flow
at (1, 2), facing toward other
at (1, 2, k), facing directly toward other
at (1, 2), facing away from (5, 5 * k)
at (1, 2), facing directly away from (5, 5, 5)
at (1, 2), apparently facing 0.3 * k
at (1, 2), apparently facing 0.3 from other
left of other
right of other by 2 * k
ahead of other by (1, 2, 3)
behind place by k
left of (k, 2) by 1
offset by (1, 2 * k)
offset along 0.5 by (1, 2)
offset along flow by (k, 2)
beyond other by 3
beyond other by (1, 2, 3) from place
in spot
on spot
following flow for 3 * k
following flow from place for 3
at (1, 2), with viewAngle k
at (1, 2), with viewAngles (k, 2)
at (1, 2), with viewRayCount (10, 20)
at (1, 2), with color (k, 0.5, 0)
at (1, 2), with velocity (1, 2)
at (1, 2), facing 0.4, with speed 3
at (1, 2), with parentOrientation 0.5, with yaw 0.25
at (1, 2), with yaw 4, with pitch 1, with roll -4
at (1, 2), with baseOffset (0, 0, k)
at (1, 2), with tag [k, "a", other.width]
at (1, 2), with tag (0.5 relative to flow)
at (1, 2), with width True, with length 2 * k
at (1, 2), with m 5
at (1, 2), with visibleDistance 3, with occluding 0
at (1, 2), with angularVelocity (k, 2, 3), with onDirection (0, 0, 1)
at (1, 2), with sideComponentThresholds ((-1, 1), (-1, 1), (-1, 1)), with contactTolerance k
"""
CLASSES = """
foo = 7
flow = VectorField("flow", lambda p: 0.1 * p.x)
spot = PointSetRegion("spot", [(3, 4, 0)])
class Thing(Object):
    allowCollisions: True
    a: self.width * 2
    b[dynamic]: self.a + self.position.x
    c[dynamic, final]: self.heading + self.b
    m[additive]: 1
    n: (self.length, foo)
class More(Thing):
    width: 3
    m[additive]: self.a
"""


@pytest.mark.parametrize("mode_2d", [False, True])
def test_objects_have_the_same_properties_wherever_they_are_made(mode_2d: bool) -> None:
    """By a program of definite values, by one of drawn ones, and in a simulation."""
    made = ", ".join(f"new More {line}" for line in SPECIFIED.strip().splitlines())
    given = (
        "other = new Thing at (10, 10, 2 * k), facing (0.3, 0.2 * k, 0.1), with width 2, with height 3",
        "place = new OrientedPoint at (5 * k, 2), facing (0.3, 0.2, 0.1)",
        f"told = [{{name: (type(value).__name__, repr(value)) for name, value in item.properties.items()}} for item in [{made}]]",
    )
    rest = "\n".join(given[:2])
    definite, drawn = (
        params(f"k = {k}\n{CLASSES}ego = new Object\n{rest}\nparam made = [{made}]\n", mode2D=mode_2d)["made"]
        for k in ("1", "Uniform(1, 1)")
    )
    body = "".join(f"        {line}\n" for line in given)
    one = scene(
        f"k = Uniform(1, 1)\n{CLASSES}scenario Main():\n    setup:\n        ego = new Object\n    compose:\n        do Sub()\n"
        f"scenario Sub():\n    setup:\n{body}        record initial told as told\n    compose:\n        wait\n",
        mode2D=mode_2d,
    )
    done = DummySimulator().simulate(one, maxSteps=1)
    assert done is not None
    for line, first, second, third in zip(
        SPECIFIED.strip().splitlines(), definite, drawn, done.records["told"], strict=True
    ):
        for name, value in first.properties.items():
            shown = (type(value).__name__, repr(value))
            again = second.properties[name]
            assert (type(again).__name__, repr(again)) == shown, (line, name)
            assert third[name] == shown, (line, name)
