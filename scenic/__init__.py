"""Scenic: compile, check and sample programs that describe scenes.

>>> import scenic
>>> scenario = scenic.scenarioFromString("ego = new Object at (Range(0, 1), 0)")
>>> [scene] = scenario.sample(1, seed=7)
>>> 0 <= scene.egoObject.position.x <= 1
True

Names are looked up when they are first used, so that ``scenic check`` and the language server start without
NumPy and the geometry libraries.
"""

import sys

if sys.argv[:1] == ["-m"] and not sys.flags.safe_path:
    # `python -m scenic...` looks for modules in the present folder first. What lies there may be anything: a program finds
    # the modules beside it by itself, and the language server runs nothing of the folder that it is started in.
    _started = sys.orig_argv[sys.orig_argv.index("-m") + 1 :][:1] if "-m" in sys.orig_argv else []
    if _started and _started[0].partition(".")[0] == "scenic":
        del sys.path[0]

from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from scenic.language.garbage import import_lasting
from scenic.language.names import SENSORS

if TYPE_CHECKING:
    from scenic.compiler.parser import ParseResult, parse
    from scenic.estimation.estimating import estimate
    from scenic.falsification.search import falsify
    from scenic.formats.reading import read_scenes
    from scenic.formats.trajectory_reading import read_trajectory
    from scenic.graph.points import GivenPoints, Sobol
    from scenic.language.errors import (
        InvalidScenarioError,
        ParseCompileError,
        RandomControlFlowError,
        RejectionException,
        ScenicError,
        ScenicSyntaxError,
        ScenicWarning,
        SpecifierError,
    )
    from scenic.pipeline import Scenario, Scene, analyze, load, scenarioFromFile, scenarioFromString
    from scenic.runtime.elements.sensors import *  # noqa: F403  (declared in `scenic.language.names`)
    from scenic.runtime.elements.specifiers import specifier
    from scenic.runtime.python.allowed import allowed
    from scenic.runtime.python.bounded import bounded
    from scenic.runtime.scenes.established_api import setDebuggingOptions, setSeed
    from scenic.simulators.replays import Conditioned

_HOMES = MappingProxyType(
    {
        "ParseResult": "scenic.compiler.parser",
        "parse": "scenic.compiler.parser",
        "Conditioned": "scenic.simulators.replays",
        "GivenPoints": "scenic.graph.points",
        "Sobol": "scenic.graph.points",
        "InvalidScenarioError": "scenic.language.errors",
        "ParseCompileError": "scenic.language.errors",
        "RandomControlFlowError": "scenic.language.errors",
        "RejectionException": "scenic.language.errors",
        "ScenicError": "scenic.language.errors",
        "ScenicSyntaxError": "scenic.language.errors",
        "ScenicWarning": "scenic.language.errors",
        "SpecifierError": "scenic.language.errors",
        "analyze": "scenic.pipeline",
        "allowed": "scenic.runtime.python.allowed",
        "bounded": "scenic.runtime.python.bounded",
        "estimate": "scenic.estimation.estimating",
        "falsify": "scenic.falsification.search",
        "load_ipython_extension": "scenic.notebook",
        "load": "scenic.pipeline",
        "read_scenes": "scenic.formats.reading",
        "read_trajectory": "scenic.formats.trajectory_reading",
        "scenarioFromFile": "scenic.pipeline",
        "scenarioFromString": "scenic.pipeline",
        "Scenario": "scenic.pipeline",
        "Scene": "scenic.pipeline",
        "setDebuggingOptions": "scenic.runtime.scenes.established_api",
        "setSeed": "scenic.runtime.scenes.established_api",
        "specifier": "scenic.runtime.elements.specifiers",
        **{name: each.home.partition(":")[0] for name, each in SENSORS.items() if each.home is not None},
    }
)

_PACKAGES = frozenset({"core", "domains", "simulators", "syntax"})
"""Packages that scripts find after a bare ``import scenic``."""

__all__ = [
    "Conditioned",
    "GivenPoints",
    "InvalidScenarioError",
    "ParseCompileError",
    "ParseResult",
    "RandomControlFlowError",
    "RejectionException",
    "Scenario",
    "Scene",
    "ScenicError",
    "ScenicSyntaxError",
    "ScenicWarning",
    "Sobol",
    "SpecifierError",
    "analyze",
    "allowed",
    "bounded",
    "estimate",
    "falsify",
    "load",
    "parse",
    "read_scenes",
    "read_trajectory",
    "scenarioFromFile",
    "scenarioFromString",
    "setDebuggingOptions",
    "setSeed",
    "specifier",
    *SENSORS,
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("scenic-lang")
    if name in _PACKAGES:
        return import_lasting(f"scenic.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module 'scenic' has no attribute {name!r}")
    home = sys.modules.get(_HOMES[name]) or import_lasting(_HOMES[name])
    return getattr(home, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
