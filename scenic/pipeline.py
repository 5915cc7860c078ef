"""Joins the layers: compile, run the program once, analyse, plan. What the API and the commands call."""

import inspect
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import CodeType, FrameType, ModuleType, TracebackType
from typing import Any, Final

from scenic.analysis.contraction import contract
from scenic.analysis.facts import Fact
from scenic.compiler import loader
from scenic.compiler.compile import compile_text
from scenic.compiler.tracebacks import SOURCE_NAME, Locator, locate, raised_at
from scenic.language.diagnostics import Diagnostic, Label
from scenic.language.errors import (
    InvalidScenarioError,
    Located,
    RejectionException,
    ScenarioChoiceError,
    ScenicSyntaxError,
    annotate,
    annotation,
    compile_error,
)
from scenic.language.garbage import promote_young
from scenic.language.source import Source, read_source
from scenic.language.spans import Span
from scenic.language.spelling import nearest, nearest_attribute
from scenic.runtime.dynamics.definitions import ModularScenario
from scenic.runtime.instances.mutation import apply_noise
from scenic.runtime.instances.objects import Object, Point
from scenic.runtime.program.context import Context, current
from scenic.runtime.program.outcome import Module, Program
from scenic.runtime.program.prelude import Loader
from scenic.runtime.python.importing import beside
from scenic.runtime.python.random_state import preserved, seed_globals
from scenic.runtime.regions.base import Everywhere, Nowhere, Region, Workspace
from scenic.runtime.scenes.saving import program_digest
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.values.values import is_random

PROGRAM_SEED = 0
"""Seed of Python's and NumPy's global generators while a program runs, so that it builds the same graph each time."""


def load(
    path: str | Path,
    *,
    params: Mapping[str, Any] | None = None,
    model: str | None = None,
    scenario: str | None = None,
    mode2D: bool = False,
    prune: bool = True,
) -> Scenario:
    """The scenario of a file.

    Args:
        path: a ``.scenic`` file; ``-`` reads the program from standard input.
        params: values for global parameters, which win over the program's own.
        model: a world model to use in place of the program's.
        scenario: which scenario of the file, where it defines several.
        mode2D: compile in the 2D compatibility mode.
        prune: narrow the distributions to what the requirements allow, which changes nothing but speed.

    Raises:
        ScenicSyntaxError: if the program cannot be compiled.
        InvalidScenarioError: if it describes no scenario, or a parameter is unknown.
        ScenicError: for the other mistakes of section 14 of the specification.

    """
    file = Path(path)
    source = Source(sys.stdin.read(), "<stdin>") if str(path) == "-" else read_source(file)
    return _scenario(
        source.text, source.filename, params or {}, model, scenario, mode2D, prune=prune, strict_params=True
    )


_EXTENSIONS: Final = (".scenic", ".sc")


def scenarioFromFile(
    path: str | Path,
    params: Mapping[str, Any] | None = None,
    model: str | None = None,
    scenario: str | None = None,
    *,
    mode2D: bool = False,
) -> Scenario:
    """The scenario of a file; the established name of `load`.

    Parameters that the program does not use are accepted, and appear among the parameters of its scenes.

    Raises:
        RuntimeError: if the file's name ends otherwise than in ``.scenic`` or ``.sc``.

    """
    source = read_source(Path(path))
    if Path(path).suffix not in _EXTENSIONS:
        raise RuntimeError(f"'{path}' is no Scenic program by its name: it ends in neither .scenic nor .sc")
    return _scenario(source.text, str(path), params or {}, model, scenario, mode2D, prune=_pruning_wanted())


def scenarioFromString(
    text: str,
    params: Mapping[str, Any] | None = None,
    model: str | None = None,
    scenario: str | None = None,
    *,
    filename: str = "<string>",
    mode2D: bool = False,
) -> Scenario:
    """The scenario of a program given as text."""
    return _scenario(text, filename, params or {}, model, scenario, mode2D, prune=_pruning_wanted())


def _pruning_wanted() -> bool:
    """Scripts switch pruning off by ``scenic.syntax.translator.usePruning = False``."""
    return bool(getattr(sys.modules.get("scenic.syntax.translator"), "usePruning", True))


def deep_check(path: str | Path) -> tuple[Diagnostic, ...]:
    """What is wrong with a program, found by running and analysing it (no scene is sampled)."""
    from scenic.analysis.report import prove

    filename = str(path)
    try:
        scenario = load(path, prune=False)
    except ScenicSyntaxError as error:
        return error.diagnostics
    except Exception as error:
        found = diagnose(error)
        if found is None:
            raise
        return (found,)
    return tuple(
        Diagnostic(
            item.code,
            item.message,
            item.span,
            item.severity,
            item.filename or filename,
            item.help,
            item.labels,
        )
        for item in prove(scenario.outline.graph, conditions(scenario))
    )


def conditions(scenario: Scenario) -> list[Fact]:
    """The hard requirements of a scenario, as analysis reads them: those of the program, then containment and visibility."""
    outline = scenario.outline
    return [
        *(Fact(item.condition, item.label, item.span, False, item.filename) for item in outline.requirements),
        *(Fact(item.node, item.label, item.span, True, item.filename) for item in outline.built_in),
    ]


def diagnose(error: BaseException) -> Diagnostic | None:
    """An exception as a diagnostic: with its place in the program, if the program or its use caused it."""
    if isinstance(error, Located):
        return error.diagnostic()
    told = annotation(error)
    if told is not None:
        return _with_origin(told, error)
    place = locate(error.__traceback__) if error.__traceback__ is not None else None
    if place is None:
        return None
    if isinstance(error, ModuleNotFoundError):
        return Diagnostic(
            "SC406",
            f"there is no module {error.name!r}",
            place.span,
            filename=place.filename,
            help="modules are .scenic files beside the program, or anything that Python can import",
        )
    near = nearest_attribute(error)
    found = Diagnostic(
        "SC400",
        f"{type(error).__name__}: {error}",
        place.span,
        filename=place.filename,
        help=f"did you mean `{near}`?" if near else "the program raised this exception while it ran",
    )
    return _with_origin(found, error)


def _with_origin(found: Diagnostic, error: BaseException) -> Diagnostic:
    """The diagnostic with the line that raised the exception, where that is another one."""
    origin = raised_at(error)
    if origin is None or found.span is None or found.labels:
        return found
    if origin.filename == found.filename and found.span.line <= origin.span.line <= found.span.end_line:
        return found
    return replace(found, labels=(Label(origin.span, "raised here", origin.filename),))


# From text to scenario


class _Modules:
    """Scenic modules beside the program and on Python's path."""

    def __init__(self, folder: Path) -> None:
        self._path = [str(folder), *sys.path]

    def find(self, name: str) -> Path | None:
        return loader.find_module(name, self._path)

    def code(self, path: Path) -> CodeType:
        return loader.load_code(path)


def _scenario(
    text: str,
    filename: str,
    params: Mapping[str, Any],
    model: str | None,
    chosen: str | None,
    mode_2d: bool,
    *,
    prune: bool = True,
    strict_params: bool = False,
) -> Scenario:
    options = {"params": dict(params), "model": model, "scenario": chosen, "2d": mode_2d}
    compiled = compile_text(text, filename=filename)
    if compiled.code is None:
        errors = [item for item in compiled.diagnostics if item.severity == "error"]
        failure = compile_error(errors, filename=filename)
        failure.program = text
        raise failure
    locator = Locator()

    def span_of(where: FrameType | TracebackType) -> Span | None:
        place = locator.place(where)
        return None if place is None else place.span

    context = Context(locate=span_of, name=locator.name, mode_2d=mode_2d)
    program = Program(overrides=dict(params), context=context)
    modules = Loader(_Modules(Path(filename).parent), context, program, model=model)
    token = current.set(context)
    try:
        with preserved(), beside(Path(filename).parent):
            seed_globals(PROGRAM_SEED)
            module, state = modules.run(compiled.code, filename, {SOURCE_NAME: Source(text, filename)})
            program.top = _run_chosen(module, state, chosen)
            program.ego, program.workspace = state.ego, state.workspace
            apply_noise(program)
            if context.looks:
                # What may stand in the way of a look is all there only now.
                program.requirements[:] = [requirement.rebuilt() for requirement in program.requirements]
        _settle_parameters(program, strict=strict_params)
        scenario = Scenario(
            program,
            filename=filename,
            ego=state.ego,
            workspace=state.workspace,
            names=_names(module, state.ego),
            regions=_regions(module),
            mode_2d=mode_2d,
            digest=program_digest(text, options),
            view=show_page,
            recipe=(_anew, (text, filename, dict(params), model, chosen, mode_2d, prune, strict_params)),
        )
    except SystemExit as error:
        place = locate(error.__traceback__) if error.__traceback__ is not None else None
        raise InvalidScenarioError(
            f"the program ended itself (`sys.exit`, with {error.code!r}) before it described a scenario",
            span=None if place is None else place.span,
            filename=filename if place is None else place.filename,
            help="raise an exception that says what is wrong instead",
        ) from error
    except RejectionException as error:
        place = locate(error.__traceback__) if error.__traceback__ is not None else None
        raise InvalidScenarioError(
            "the program rejected itself while it ran: every scene would be rejected",
            span=None if place is None else place.span,
            filename=filename if place is None else place.filename,
            help="raise `RejectionException` only in what is evaluated on samples",
        ) from error
    except Located as error:
        if error.span is None or error.filename is None:
            place = locate(error.__traceback__) if error.__traceback__ is not None else None
            error.span = error.span or (place.span if place else None)
            error.filename = error.filename or (place.filename if place else filename)
        if error.filename == filename:
            error.program = text
        raise
    except Exception as error:
        found = diagnose(error)
        if found is not None and found.span is not None:
            annotate(
                error,
                found,
                f"{found.filename}:{found.span.line}:{found.span.column + 1}: raised while the program ran",
            )
        raise
    finally:
        current.reset(token)
    if prune:
        pruning = contract(scenario.outline.graph, conditions(scenario))
        scenario.restrict(pruning.domain, impossible=[item.label for item in pruning.impossible])
    scenario.prepare()
    promote_young()
    return scenario


def show_page(scene: Any) -> Path:
    """Write a page that shows a scene to a temporary file, open it in a browser, and return the file."""
    import tempfile
    import webbrowser

    from scenic.formats.html import page

    file = Path(tempfile.mkdtemp(prefix="scenic-")) / "scene.html"
    file.write_text(page([scene], "scene"), encoding="utf-8")
    webbrowser.open(file.as_uri())
    return file


def _anew(
    text: str,
    filename: str,
    params: Mapping[str, Any],
    model: str | None,
    chosen: str | None,
    mode_2d: bool,
    prune: bool,
    strict: bool,
) -> Scenario:
    """A scenario compiled once more, after it was pickled."""
    return _scenario(text, filename, params, model, chosen, mode_2d, prune=prune, strict_params=strict)


def _run_chosen(module: ModuleType, state: Module, chosen: str | None) -> ModularScenario | None:
    """Run the set-up of the scenario that the file means (section 2.6 of the specification)."""
    defined = {
        item.__name__: item
        for item in vars(module).values()
        if isinstance(item, type)
        and issubclass(item, ModularScenario)
        and item._definition.setup is not None
        and item._definition.setup.__globals__ is vars(module)
    }
    if chosen is not None and chosen not in defined:
        near = nearest(chosen, defined)
        known = ", ".join(sorted(defined)) or "none"
        raise ScenarioChoiceError(
            f"there is no scenario {chosen!r}",
            filename=state.filename,
            help=f"did you mean {near!r}?" if near else f"scenarios of this file: {known}",
        )
    scenario = defined.get(chosen or "Main")
    if scenario is None and len(defined) == 1:
        (only,) = defined.values()
        scenario = None if _needed(only) else only
    if scenario is None:
        if len(defined) > 1:
            raise ScenarioChoiceError(
                f"the file defines {len(defined)} scenarios: {', '.join(defined)}",
                filename=state.filename,
                help="choose one with `--scenario NAME`",
            )
        return None
    needed = _needed(scenario)
    if needed:
        raise ScenarioChoiceError(
            f"scenario {scenario.__name__!r} needs arguments: {', '.join(needed)}",
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
            known = ", ".join(sorted(program.parameters)) or "none"
            near = nearest(name, program.parameters)
            raise InvalidScenarioError(
                f"the program has no parameter {name!r}",
                code="SC603",
                help=f"did you mean {near!r}?" if near else f"its parameters: {known}",
            )
        program.parameters[name] = value


def _names(module: ModuleType, ego: Object | None) -> dict[int, str]:
    """Variables of the module that hold instances."""
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
    """Variables of the module that hold regions with bounds; the workspace is known as such."""
    return {
        name: value
        for name, value in vars(module).items()
        if isinstance(value, Region)
        and not isinstance(value, Workspace | Everywhere | Nowhere)
        and not name.startswith("_")
    }


__all__ = [
    "conditions",
    "deep_check",
    "diagnose",
    "load",
    "scenarioFromFile",
    "scenarioFromString",
]
