"""A project of many files, all of them right: nothing is called wrong that another file brings."""

from pathlib import Path

from scenic.compiler.check import check_text
from scenic.language.diagnostics import Severity
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

FILES = {
    "world/__init__.py": "from .units import *\nfrom .units import KILO as THOUSAND\n__version__ = '1'\n",
    "world/units.py": "__all__ = ['KILO', 'metres']\nKILO = 1000\ndef metres(km, *, scale=KILO):\n    return km * scale\n",
    "world/base.scenic": "param weather = 'dry'\nclass Thing(Object):\n    mass: 1\n    load[final]: self.mass * 2\nroad = RectangularRegion(0 @ 0, 0, 50, 50)\n",
    "world/vehicles.scenic": "from world.base import *\nimport world.units as units\n"
    "class Car(Thing):\n    speed: units.metres(1) / 1000\n    driver: None\n"
    "    def faster(self, more=1):\n        return self.speed + more\nclass Truck(Car):\n    trailer: None\n",
    "world/driving.scenic": "from world.vehicles import Car\nbehavior Drive(speed, *, brake=0):\n    take speed, brake\n"
    "behavior Follow(other: Car, gap=3):\n    try:\n        do Drive(other.speed)\n"
    "    interrupt when (distance from self to other) < gap:\n        do Drive(0, brake=1) for 1 seconds\n",
    "world/model.scenic": "model world.base\nfrom world.vehicles import *\nfrom world.driving import Drive, Follow as Chase\nHELPERS = [Drive]\n",
    "world/parts.scenic": "model world.model\nscenario Ahead(gap=5):\n    setup:\n        lead = new Car ahead of ego by gap, with behavior Drive(2)\n"
    "scenario Pair(first, second=None):\n    compose:\n        do first, Ahead(gap=2)\n",
}
PROGRAMS = {
    "plain": "model world.model\nego = new Car with speed 3, with behavior Drive(2)\nrequire ego in road\n",
    "chain": "model world.model\nego = new Truck with trailer None, with mass 3\nrequire ego.load > 2 and ego.faster(more=2) > 1\n",
    "star": "from world.model import *\nego = new Car on road, with behavior Chase(None, gap=2)\nx = HELPERS[0](1)\n",
    "units": "import world\nfrom world import metres, THOUSAND\nego = new Object at (metres(1), world.KILO)\nprint(world.__version__, THOUSAND)\n",
    "subclass": "model world.model\nclass Taxi(Truck):\n    fare[dynamic]: self.speed + self.load\nego = new Taxi with fare 2\nrequire ego.fare > 1\n",
    "mixin": "model world.model\nclass Loud:\n    def horn(self): return 1\nclass Siren(Car, Loud):\n    colour: 'red'\nego = new Siren\nprint(ego.horn())\n",
    "behaviors": "from world.driving import *\nbehavior Twice():\n    do Drive(1) for 2 seconds\n    do Follow(ego, 2)\nego = new Car with behavior Twice()\n",
    "scenarios": "from world.parts import *\nscenario Main():\n    setup:\n        ego = new Car\n    compose:\n        do Pair(Ahead(), second=3)\n",
    "module": "import world.vehicles\nimport world.parts as parts\nego = new Object\nCar = world.vehicles.Car\nother = new Car at 5 @ 5\nscenario Main():\n    compose:\n        do parts.Ahead(3)\n",
    "guarded": "try:\n    from nowhere_at_all import Fast\nexcept ImportError:\n    from world.driving import Drive as Fast\nmodel world.base\nego = new Thing with behavior Fast(2)\n",
    "loops": "model world.model\nego = new Car\ncars = [new Car at (x, 5) for x in range(2, 9, 3)]\nfor each in cars:\n    require each.speed < 9\n",
    "records": "model world.model\nego = new Car with behavior Drive(1)\nrecord ego.speed as v\nterminate when ego.speed > 8\nmonitor Watch(car: Car):\n    while True:\n        if car.speed > 3: terminate\n        wait\nrequire monitor Watch(ego)\n",
    "globals": "model world.model\nego = new Car\nrequire globalParameters.weather == 'dry'\nparam weather = Uniform('dry', 'wet')\n",
    "functions": "model world.model\nego = new Car\ndef near(car, gap=2):\n    return new Truck left of car by gap\nnear(ego)\n",
    "tests/relative": "from .helpers import start\nfrom ..world.units import KILO\nego = new Object at (start(KILO), 0)\n",
    "tests/deep/two": "from ..helpers import *\nfrom ...world.base import Thing\nego = new Thing at (start(1), LIMIT)\n",
    "override": "model world.model\nego = new Car\nscenario Main():\n    setup:\n        override ego with width 3\n    compose:\n        wait\n",
    "interrupts": "model world.model\nbehavior Careful(limit=3):\n    try:\n        do Chase(ego)\n    interrupt when self.speed > limit:\n        do Drive(1) until self.speed < limit\nego = new Car\nnew Truck behind ego by 4, with behavior Careful(limit=2)\n",
    "choices": "model world.model\nbehavior Any():\n    do choose {Drive(1): 2, Drive(2): 1}\n    do shuffle Drive(1), Chase(ego)\nego = new Car with behavior Any()\n",
    "temporal": "model world.model\nego = new Car\nother = new Truck visible from ego\nrequire always (ego can see other) implies eventually other.speed < 2\n",
}
HELPERS = {
    "tests/__init__.py": "",
    "tests/helpers.py": "LIMIT = 3\ndef start(x):\n    return x + LIMIT\n",
    "tests/deep/__init__.py": "",
}


def errors_of(folder: Path, programs: dict[str, str]) -> dict[str, list[str]]:
    """The errors of each program of a project, none of which is run."""
    texts = {**FILES, **HELPERS, **{f"{name}.scenic": text for name, text in programs.items()}}
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    surroundings_of = surroundings_in(Project([str(folder)]))
    return {
        name: found
        for name, text in texts.items()
        if name.endswith(".scenic")
        and (
            found := [
                f"{each.code} {each.span and each.span.line}: {each.message}"
                for each in check_text(text, filename=str(folder / name), surroundings_of=surroundings_of)
                if each.severity is Severity.ERROR
            ]
        )
    }


def test_right_programs_of_a_project_have_no_errors(tmp_path: Path) -> None:
    assert len(PROGRAMS) >= 20
    assert not errors_of(tmp_path, PROGRAMS)


def test_what_the_chain_of_models_does_not_bring_is_found(tmp_path: Path) -> None:
    wrong = {
        "model": "model world.model\nego = new Car with behavior Drve(2)\n",
        "star": "from world.vehicles import *\nego = new Car\nprint(Cra)\n",
    }
    assert {name: found[0][:5] for name, found in errors_of(tmp_path, wrong).items()} == {
        "model.scenic": "SC202",
        "star.scenic": "SC202",
    }
