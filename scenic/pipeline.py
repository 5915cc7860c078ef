"""Joins the layers: compile, run the program once, analyse, plan. What the API and the commands call."""

import inspect
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from functools import cache, partial
from pathlib import Path
from types import CodeType, FrameType, ModuleType, TracebackType
from typing import TYPE_CHECKING, Any, Final

from scenic.compiler import loader
from scenic.compiler.tracebacks import SOURCE_NAME, Locator
from scenic.dataclass import dataclass
from scenic.failures import placed
from scenic.language.errors import (
    InvalidScenarioError,
    ScenarioChoiceError,
    ScenicSyntaxError,
)
from scenic.language.garbage import promote_young
from scenic.language.source import Source, read_source
from scenic.language.spans import Span
from scenic.language.spelling import nearest
from scenic.narrowing import prepared_sampler
from scenic.runtime.description.definitions import ModularScenario
from scenic.runtime.description.mutation import apply_noise
from scenic.runtime.description.outcome import Program, RunningModule
from scenic.runtime.geometry.store import programs_folder
from scenic.runtime.ground.context import Context, current, warn
from scenic.runtime.instances.objects import Object, Point
from scenic.runtime.program.prelude import Loader
from scenic.runtime.python.importing import beside
from scenic.runtime.python.random_state import is_as, preserved, seed_globals, states
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.spaces import Everywhere, Nowhere, Workspace, everywhere
from scenic.runtime.sampling.check_planning import Outline, outline
from scenic.runtime.scenes import scenario as scenarios
from scenic.runtime.scenes import scene as scenes
from scenic.runtime.scenes.saving import program_digest
from scenic.runtime.values.values import is_random

if TYPE_CHECKING:
    from scenic.assessment.assessment import Assessment
    from scenic.batch.simulations import SimulationRow
    from scenic.runtime.scenes.external_candidates import ExternalPoints

PROGRAM_SEED = 0
"""Seed of Python's and NumPy's global generators while a program runs, so that it builds the same graph each time."""


class Scene(scenes.Scene):
    __doc__ = scenes.Scene.__doc__

    def show(self, axes: bool = True) -> Path:
        """Show the scene in a browser, as a page in which it can be turned; returns the file of the page.

        ``axes`` is accepted for compatibility.
        """
        import tempfile
        import webbrowser

        from scenic.formats.html import page

        file = Path(tempfile.mkdtemp(prefix="scenic-")) / "scene.html"
        file.write_text(page([self], "scene"), encoding="utf-8")
        webbrowser.open(file.as_uri())
        return file

    show3D = show

    def show2D(self, zoom: object = None, block: bool = True) -> Path:
        """Return the same as `show`; the arguments are accepted for compatibility."""
        return self.show()

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> Mapping[str, str]:
        """Return the scene by type of media, as notebooks ask for it: a page in which it can be turned, and text."""
        from scenic.formats.embedding import scene_bundle

        return scene_bundle(self)

    def save(self, path: str | Path) -> None:
        """Write the scene to a file, which `Scenario.replay` reads; the file is complete or absent.

        If its name ends in ``.usda``, ``.usdc``, ``.usdz`` (OpenUSD), ``.xml`` (MJCF), ``.sdf`` (SDFormat), ``.cr.xml`` (CommonRoad) or
        ``.wbt`` (Webots), the file is a scene of another program instead, which `replay` does not read.
        """
        if not _export(self, Path(path)):
            super().save(path)


class Scenario(scenarios.Scenario):
    __doc__ = scenarios.Scenario.__doc__
    scene_class = Scene

    def simulate(self, n: int = 1, **options: Any) -> "list[SimulationRow]":
        """Simulate scenes 0 to ``n`` of a seed; see `scenic.batch.simulations.simulated` for the options and the result."""
        from scenic.batch.simulations import simulated

        return simulated(self, n, **options)

    def __reduce__(self) -> tuple[Any, ...]:
        return _scenario, (self.text, self.filename, _Options.of(self.options))

    def _in_processes(self, n: int, **options: Any) -> "Iterator[scenes.Scene]":
        from scenic.batch.scenes import sampled_in_processes

        return sampled_in_processes(self, n, **options)

    def _external_points(self) -> "ExternalPoints":
        from scenic.falsification.external import external_points

        return external_points(self)

    def _compiled_again(
        self, params: Mapping[str, object], settle: tuple[float, float, bool] | None = None
    ) -> "Scenario":
        options = _Options.of(self.options)
        changed = replace(options, params={**options.params, **params}, settle=settle or options.settle)
        return _scenario(self.text, self.filename, changed)


def load(
    path: str | Path,
    *,
    params: Mapping[str, Any] | None = None,
    model: str | None = None,
    scenario: str | None = None,
    mode2D: bool = False,
    prune: bool = True,
    extra_params: bool = False,
    settle: float | None = None,
    settle_tolerance: float = 0.01,
    settle_keep: bool = False,
) -> Scenario:
    """Return the scenario of a file.

    Args:
        path: a ``.scenic`` file; ``-`` reads the program from standard input.
        params: values for global parameters, which replace the program's own.
        model: a world model to use instead of the program's.
        scenario: the scenario to use, if the file defines several.
        mode2D: compile in the 2D compatibility mode.
        prune: narrow the distributions to the values that the requirements allow. The distribution of the scenes is the same.
        extra_params: accept values of parameters that the program does not have, and add them to its scenes.
        settle: seconds of a simulation in MuJoCo in which no object of a scene may move, nor turn by more than 5 degrees.
        settle_tolerance: the distance that is not yet moving, metres.
        settle_keep: give scenes the poses in which their objects are after that simulation, instead of rejecting scenes in which
            objects move. Requirements are about the poses before. Only objects that are still moving reject a scene.

    Raises:
        ScenicSyntaxError: if the program cannot be compiled.
        InvalidScenarioError: if it does not describe a scenario, or a parameter is unknown.
        ScenicError: for the other mistakes of section 14 of the specification.

    """
    file = Path(path)
    source = Source(sys.stdin.read(), "<stdin>") if str(path) == "-" else read_source(file)
    options = _Options(
        dict(params or {}),
        model,
        scenario,
        mode2D,
        prune,
        strict_params=not extra_params,
        settle=None if settle is None else (settle, settle_tolerance, settle_keep),
    )
    return _scenario(source.text, source.filename, options, keep=str(path) != "-")


_EXTENSIONS: Final = (".scenic", ".sc")


def scenarioFromFile(
    path: str | Path,
    params: Mapping[str, Any] | None = None,
    model: str | None = None,
    scenario: str | None = None,
    *,
    mode2D: bool = False,
) -> Scenario:
    """Return the scenario of a file; the established name of `load`.

    Parameters that the program does not use are accepted, and appear among the parameters of its scenes.

    Raises:
        RuntimeError: if the file's name does not end in ``.scenic`` or ``.sc``.

    """
    source = read_source(Path(path))
    if Path(path).suffix not in _EXTENSIONS:
        raise RuntimeError(f"'{path}' is no Scenic program by its name: it ends in neither .scenic nor .sc")
    options = _Options(dict(params or {}), model, scenario, mode2D, _pruning_wanted())
    return _scenario(source.text, str(path), options, keep=True)


def scenarioFromString(
    text: str,
    params: Mapping[str, Any] | None = None,
    model: str | None = None,
    scenario: str | None = None,
    *,
    filename: str = "<string>",
    mode2D: bool = False,
) -> Scenario:
    """Return the scenario of a program given as text."""
    return _scenario(text, filename, _Options(dict(params or {}), model, scenario, mode2D, _pruning_wanted()))


def _pruning_wanted() -> bool:
    """Scripts switch pruning off by ``scenic.syntax.translator.usePruning = False``."""
    return bool(getattr(sys.modules.get("scenic.syntax.translator"), "usePruning", True))


def analyze(
    program: str | Path | Scenario,
    *,
    params: Mapping[str, Any] | None = None,
    model: str | None = None,
    scenario: str | None = None,
    mode2D: bool = False,
    candidates: int | None = None,
) -> "Assessment":
    """The cost of sampling a program: what analysis removes, how many candidates pass, which requirement costs most.

    Args:
        program: a ``.scenic`` file, or a scenario.
        params: as for `load`, like the next three; not allowed if ``program`` is a scenario.
        model: a world model to use instead of the program's.
        scenario: which scenario of the file.
        mode2D: compile in the 2D compatibility mode.
        candidates: largest number of candidates for estimating how many pass; 20,000 by default.

    Raises:
        ScenicError: if the program has an error, as `load` and `Scenario.sample` raise it.

    """
    from scenic.assessment.assessing import CANDIDATES, assess

    if not isinstance(program, Scenario):
        program = load(program, params=params, model=model, scenario=scenario, mode2D=mode2D)
    return assess(program, candidates=CANDIDATES if candidates is None else candidates)


# From text to scenario


class _Modules:
    """Scenic modules beside the program and on Python's path."""

    def __init__(self, folder: Path) -> None:
        self._path = [str(folder), *sys.path]

    def find(self, name: str) -> Path | None:
        return loader.find_module(name, self._path)

    def code(self, path: Path) -> CodeType:
        return loader.load_code(path)


@dataclass(frozen=True, slots=True)
class _Options:
    """Options of the compilation of a program; see `load`."""

    params: Mapping[str, Any] = field(default_factory=dict)
    model: str | None = None
    scenario: str | None = None
    mode_2d: bool = False
    prune: bool = True
    strict_params: bool = False
    """True if a parameter that the program does not use is an error."""
    settle: tuple[float, float, bool] | None = None
    """Seconds of a simulation in which no object moves, the distance that is not yet moving (metres), and whether settled poses are kept."""

    def digest(self, text: str, bare: str | None) -> str:
        """Return the digest of a program, whatever its comments and blanks, and of all options that change its scenes.

        ``bare`` is its text without these, where that is known.
        """
        if bare is None:
            from scenic.compiler.parser import bare_text  # takes long to import, and few runs need it

            bare = bare_text(text)
        return program_digest(
            bare,
            {
                "params": dict(self.params),
                "model": self.model,
                "scenario": self.scenario,
                "2d": self.mode_2d,
                **({} if self.settle is None else {"settle": list(self.settle)}),
            },
        )

    def given(self) -> dict[str, Any]:
        """Return the keyword arguments of `load` that differ from the defaults."""
        arguments: dict[str, Any] = {}
        if self.params:
            arguments["params"] = dict(self.params)
            if not self.strict_params:
                arguments["extra_params"] = True
        if self.model is not None:
            arguments["model"] = self.model
        if self.scenario is not None:
            arguments["scenario"] = self.scenario
        if self.mode_2d:
            arguments["mode2D"] = True
        if not self.prune:
            arguments["prune"] = False
        if self.settle is not None:
            arguments["settle"], arguments["settle_tolerance"], arguments["settle_keep"] = self.settle
        return arguments

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> "_Options":
        """Return the options of keyword arguments, as `given` lists them."""
        settle = given.get("settle")
        return cls(
            given.get("params", {}), given.get("model"), given.get("scenario"), given.get("mode2D", False),
            given.get("prune", True), not given.get("extra_params", False),
            None if settle is None else (settle, given["settle_tolerance"], given["settle_keep"]),
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class _Ran:
    """A program that has run once."""

    program: Program
    outline: Outline
    ego: Object | None
    workspace: Workspace
    names: Mapping[int, str]
    regions: Mapping[str, Region]


def _scenario(text: str, filename: str, options: _Options, *, keep: bool = False) -> Scenario:
    """Make a scenario from a text: compile, run, outline, contract."""
    program_code = _compiled(text, filename, keep=keep)
    ran = _run(program_code.code, text, filename, options)
    scenario = Scenario(
        ran.program,
        ran.outline,
        filename=filename,
        text=text,
        ego=ran.ego,
        workspace=ran.workspace,
        names=ran.names,
        regions=ran.regions,
        sampler=prepared_sampler(ran.outline, prune=options.prune),
        digest=cache(partial(options.digest, text, program_code.bare_text)),
        options=options.given(),
    )
    promote_young()
    return scenario


def _compiled(text: str, filename: str, *, keep: bool) -> loader.ProgramCode:
    """Return the code of a program, which ``keep`` puts into the store for later runs."""
    try:
        return loader.program_code(Source(text, filename), programs_folder() if keep else None)
    except ScenicSyntaxError as failure:
        failure.program = text
        raise


def _run(code: CodeType, text: str, filename: str, options: _Options) -> _Ran:
    """Run a program once, which makes its graph."""
    locator = Locator()

    def span_of(where: FrameType | TracebackType, instruction: int | None = None) -> Span | None:
        place = locator.place(where, instruction)
        return None if place is None else place.span

    context = Context(locate=span_of, name=locator.name, quote=locator.quote, mode_2d=options.mode_2d)
    context.filename = filename
    program = Program(overrides=dict(options.params), context=context)
    context.parameters.value = program.parameter
    context.parameters.given = frozenset(options.params)
    modules = Loader(_Modules(Path(filename).parent), context, program, model=options.model)
    token = current.set(context)
    try:
        with placed(text, filename):
            with preserved(), beside(Path(filename).parent):
                seed_globals(PROGRAM_SEED)
                generator_states = states()
                module, state = modules.run(code, filename, {SOURCE_NAME: Source(text, filename)})
                program.top = _run_chosen(module, state, options.scenario)
                program.ego, program.workspace = state.ego, state.workspace
                if not is_as(generator_states):
                    _warn_of_draws(text, filename)
                apply_noise(program)
                record = context.record
                if record.looks or record.awaits or record.has_later_elements:
                    # Only now everything is there that may hide something, or that a condition speaks of.
                    program.requirements[:] = [item.rebuilt() for item in program.requirements]
            program.module = vars(module)
            program.variables = _names(module, state.ego)
            _settle_parameters(program, strict=options.strict_params)
            workspace = state.workspace or Workspace(everywhere)
            outline = _outlined(program, workspace, options)
    finally:
        current.reset(token)
    return _Ran(program, outline, state.ego, workspace, program.variables, _regions(module))


def _warn_of_draws(text: str, filename: str) -> None:
    """Warn of a program that has drawn from the generators of Python or NumPy, once for all scenes."""
    from scenic.compiler.check import check_text

    diagnostic = next((item for item in check_text(text, filename=filename) if item.code == "SC407"), None)
    if diagnostic is not None:
        warn(
            diagnostic.message,
            code=diagnostic.code,
            span=diagnostic.span,
            filename=filename,
            help=diagnostic.help,
        )
    elif re.search(r"\brandom\b", text) and not re.search(r"\bseed\(|SC407", text):
        # Not of libraries, which draw while they are imported, nor where a seed or a comment says that it is meant.
        warn(
            "the program draws once by Python's or NumPy's `random` while it is loaded: all scenes get the same values",
            help="draw by `Range`, `DiscreteRange`, `Normal` or `Uniform`, and give functions these values",
        )


def _outlined(program: Program, workspace: Workspace, options: _Options) -> Outline:
    """Return the outline of a program that has run, with its objects at rest if the options say so."""
    if options.settle is None:
        return outline(program, program.ego, workspace, mode_2d=options.mode_2d)
    from scenic.simulators.mujoco.settling import Settling, keep_poses, require_rest

    seconds, tolerance, keep = options.settle
    settled = require_rest(program, Settling(seconds, tolerance), keep=keep)
    outlined = outline(program, program.ego, workspace, mode_2d=options.mode_2d)
    return keep_poses(program, outlined, settled) if keep else outlined


def _export(scene: Scene, path: Path) -> bool:
    """Write a scene for another program by the ending of the file's name; returns whether that is such an ending."""
    suffix = path.suffix.lower()
    if path.name.lower().endswith(".cr.xml"):
        from scenic.formats.commonroad.scenario_files import write_scene as write_roads

        write_roads(scene, path)
        return True
    if suffix == ".wbt":
        from scenic.formats.webots import write_world

        write_world(scene, path)
        return True
    from scenic.formats.robotics.scene_files import ENDINGS, write_scene

    if suffix in ENDINGS:
        write_scene(scene, path)
        return True
    return False


def _run_chosen(module: ModuleType, state: RunningModule, chosen: str | None) -> ModularScenario | None:
    """Run the set-up of the scenario that the file means (section 2.6 of the specification)."""
    scenarios = {
        item.__name__: item
        for item in vars(module).values()
        if isinstance(item, type)
        and issubclass(item, ModularScenario)
        and item._definition.setup is not None
        and item._definition.setup.__globals__ is vars(module)
    }
    if chosen is not None and chosen not in scenarios:
        near = nearest(chosen, scenarios)
        names = ", ".join(sorted(scenarios)) or "none"
        raise ScenarioChoiceError(
            f"there is no scenario {chosen!r}",
            filename=state.filename,
            help=f"did you mean {near!r}?" if near else f"scenarios of this file: {names}",
        )
    scenario = scenarios.get(chosen or "Main")
    if scenario is None and len(scenarios) == 1:
        (only,) = scenarios.values()
        scenario = None if _needed(only) else only
    if scenario is None:
        if len(scenarios) > 1:
            raise ScenarioChoiceError(
                f"the file defines {len(scenarios)} scenarios: {', '.join(scenarios)}",
                filename=state.filename,
                help="choose one with `--scenario NAME`",
            )
        return None
    missing_arguments = _needed(scenario)
    if missing_arguments:
        raise ScenarioChoiceError(
            f"scenario {scenario.__name__!r} needs arguments: {', '.join(missing_arguments)}",
            filename=state.filename,
            help="give its parameters default values",
        )
    instance = scenario()
    definition = scenario._definition
    assert definition.setup is not None
    arguments = instance._arguments
    definition.setup(instance, *arguments.args, **arguments.kwargs)
    return instance


def _needed(scenario: type[ModularScenario]) -> list[str]:
    parameters = scenario._definition.signature.parameters.values()
    variadic = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    return [
        item.name
        for item in parameters
        if item.default is inspect.Parameter.empty and item.kind not in variadic
    ]


def _settle_parameters(program: Program, *, strict: bool) -> None:
    for name, value in program.overrides.items():
        if strict and name not in program.parameters and name not in program.read_parameters:
            names = ", ".join(sorted(program.parameters)) or "none"
            near = nearest(name, program.parameters)
            raise InvalidScenarioError(
                f"the program has no parameter {name!r}",
                code="SC603",
                help=f"did you mean {near!r}?" if near else f"its parameters: {names}",
            )
        program.parameters[name] = value


def _names(module: ModuleType, ego: Object | None) -> Mapping[int, str]:
    """Return the variables of the module that contain instances, by the identity of the instance."""
    names: dict[int, str] = {}
    for name, value in vars(module).items():
        if isinstance(value, Point):
            names.setdefault(id(value), name)
        elif isinstance(value, list | tuple) and not is_random(value):
            for index, item in enumerate(value):
                if isinstance(item, Point):
                    names.setdefault(id(item), f"{name}[{index}]")
    if ego is not None:
        names.setdefault(id(ego), "ego")
    return names


def _regions(module: ModuleType) -> dict[str, Region]:
    """Return the regions that variables of the module contain, by name; the workspace, `everywhere` and `nowhere` are left out."""
    return {
        name: value
        for name, value in vars(module).items()
        if isinstance(value, Region)
        and not isinstance(value, Workspace | Everywhere | Nowhere)
        and not name.startswith("_")
    }


__all__ = [
    "load",
    "scenarioFromFile",
    "scenarioFromString",
]
