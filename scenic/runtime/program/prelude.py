"""The prelude: the one object that generated code talks to.

The compiler translates a program to Python that calls methods of ``__scenic__``, a `Prelude`, and otherwise is the program
itself. Names such as ``Range`` are not translated: they are builtins of generated modules (`builtin_names`). Each
module of a program has its own prelude; all of a compilation share a `Program` and a `Context`.

The same generated code serves two readings. While a scenario is compiled its context is symbolic and values are nodes of
the graph; during a simulation the context draws at once, and conditions are evaluated where they stand.
"""

import builtins
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import accumulate
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any, Protocol

from scenic.language.errors import (
    InvalidScenarioError,
    Located,
    RejectionException,
    ScenicTypeError,
    UnsupportedError,
)
from scenic.language.libraries import how_to_get
from scenic.runtime.description import conditions, mutation
from scenic.runtime.description.conditions import Condition
from scenic.runtime.description.declarations import Closure, label_of, required
from scenic.runtime.description.definitions import behavior_of
from scenic.runtime.description.outcome import Program, Requirement, RunningModule
from scenic.runtime.dynamics.language import Dynamics
from scenic.runtime.dynamics.run_context import RunContext
from scenic.runtime.elements.functions import convert
from scenic.runtime.elements.operators import OPERATORS
from scenic.runtime.elements.resolution import build, check_assigned
from scenic.runtime.elements.specifiers import (
    BUILDERS,
    Specifier,
    UserSpecifier,
    specify,
)
from scenic.runtime.ground.context import Context, Site, current, here
from scenic.runtime.ground.used_files import note_file, note_import
from scenic.runtime.instances.objects import Object, Point
from scenic.runtime.instances.placeholders import may_mutate, stand_in
from scenic.runtime.instances.properties import ATTRIBUTES, PropertyDefinition
from scenic.runtime.program import builtins as names
from scenic.runtime.program.starred_calls import spread
from scenic.runtime.program.symbolic import Symbolic
from scenic.runtime.python.importing import beside, forget_stranger
from scenic.runtime.python.samples import Sample
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.planar_visibility import sees_in_mode
from scenic.runtime.regions.presence import is_always_present
from scenic.runtime.regions.spaces import Workspace, everywhere
from scenic.runtime.temporal.formulas import is_temporal
from scenic.runtime.values.access import sliceable
from scenic.runtime.values.choices import per_option
from scenic.runtime.values.class_members import sample_of
from scenic.runtime.values.lazy import definite
from scenic.runtime.values.ownership import PRELUDE
from scenic.runtime.values.values import (
    describe,
    to_orientation,
)


class ModuleCompiler(Protocol):
    """Finds and compiles modules of Scenic code (`scenic.compiler.loader`, passed in)."""

    def find(self, name: str) -> Path | None:
        """Return the file of a module, or ``None`` if no Scenic module of that name exists."""

    def code(self, path: Path) -> CodeType:
        """Return the compiled code of a file; raises `ScenicSyntaxError`."""


class Prelude(Symbolic, Dynamics):
    """The object that one module of generated code calls. Method names are fixed by the compiler."""

    Object = Object

    def __init__(self, context: Context, program: Program, module: RunningModule, modules: "Loader") -> None:
        self._compilation = context
        context.objects = program.objects
        self._program = program
        self._module = module
        self._modules = modules

    @property
    def modules(self) -> Iterable[ModuleType]:
        """The modules of the language that the program has imported."""
        return self._modules.loaded

    # As a value that functions of the program reach: what they read of it is the ego

    def snapshot(self) -> "Prelude":
        """The prelude with the ego and workspace of this moment, whatever the program sets later."""
        return Prelude(self._compilation, self._program, replace(self._module), self._modules)

    def random_parts(self) -> list[Any]:
        """Return the ego, for sampling."""
        return [self._module.ego]

    def sampled(self, sample: Sample) -> "Prelude":
        """Return the prelude whose ego is that of a sample."""
        module = replace(self._module, ego=sample.value(self._module.ego))
        return Prelude(self._compilation, self._program, module, self._modules)

    def __eq__(self, other: object) -> bool:
        """Return whether two preludes are of the same module in the same state."""
        if not isinstance(other, Prelude):
            return NotImplemented
        mine, theirs = self._module, other._module
        return (
            mine.ego is theirs.ego and mine.workspace is theirs.workspace and mine.filename == theirs.filename
        )

    __hash__ = object.__hash__

    @property
    def _context(self) -> Context:
        """The context in which the program runs: the running simulation's, or else the compilation's."""
        active = current.get()
        return active if isinstance(active, RunContext) else self._compilation

    # Ego and workspace

    @property
    def ego(self) -> Any:
        """The ego object; raises `InvalidScenarioError` before it is set."""
        run = self._run
        if run is not None and run.current.ego is not None:
            return run.current.ego
        if self._module.ego is None:
            raise InvalidScenarioError(
                "the ego object is used before it is set",
                span=here(),
                help="write `ego = new Object ...` first",
            )
        return self._module.ego

    @ego.setter
    def ego(self, value: object) -> None:
        if not isinstance(value, Object):
            class_name = value.__name__ if isinstance(value, type) else "Object"
            hint = f"write `ego = new {class_name}`, with specifiers where they are needed"
            raise ScenicTypeError(f"the ego must be an object, not {describe(value)}", span=here(), help=hint)
        run = self._run
        if run is not None:
            run.current.ego = value
            for scenario in run.scenarios:
                if scenario.ego is None:
                    scenario.ego = value
        else:
            self._module.ego = value

    def _ego(self) -> Any:
        return self.ego

    def _space(self) -> Region:
        workspace = self._known_workspace()
        return everywhere if workspace is None else workspace

    @property
    def workspace(self) -> Any:
        """The workspace; all of space where the program sets none."""
        known = self._known_workspace()
        if known is None:
            raise InvalidScenarioError(
                "the workspace is used before it is set",
                span=here(),
                help="write `workspace = Workspace(region)` first",
            )
        return known

    @workspace.setter
    def workspace(self, value: object) -> None:
        if not isinstance(value, Workspace):
            raise ScenicTypeError(
                f"the workspace must be a Workspace, not {describe(value)}",
                span=here(),
                help="write `workspace = Workspace(region)`",
            )
        if self._run is not None:
            self._run.current.workspace = value
        else:
            self._module.workspace = value

    def _known_workspace(self) -> Workspace | None:
        """Return the workspace of the scenario that is running, else of the module, if it is set."""
        run = self._run
        own: Workspace | None = None if run is None else run.current.workspace
        return self._module.workspace if own is None else own

    # Instances

    def specifier(self, name: str, *operands: Any, property: str | None = None) -> Specifier:
        """Return one specifier of ``new``."""
        caller = sys._getframe(1)
        # Functions of the established API call this, too: then the place is further up.
        site = Site(caller, caller.f_lasti) if PRELUDE in caller.f_globals else None
        if name not in BUILDERS:
            raise UnsupportedError(f"the specifier `{name}` is not supported yet", span=here())
        if property is not None:
            if property == "heading" and self._context.mode_2d:
                return specify("facing", self._ego, self._space, *operands, site=site)
            user_specifier = self._module.scope.get(property)
            if isinstance(user_specifier, UserSpecifier):
                (value,) = operands
                return user_specifier(*value) if type(value) is tuple else user_specifier(value)
            operands = (property, *operands)
        return specify(name, self._ego, self._space, *operands, site=site)

    def new(self, cls: object, *specifiers: Specifier) -> Any:
        """Return a new instance of a Scenic class."""
        if not (isinstance(cls, type) and issubclass(cls, Point)):
            raise ScenicTypeError(
                f"`new` needs a Scenic class, not {describe(cls)}",
                span=here(),
                help="Python classes are called: `C(...)`",
            )
        if self._context.evaluating and issubclass(cls, Object):
            raise InvalidScenarioError(
                "a requirement cannot create an object",
                span=here(),
                help="create it before the `require` statement; points may be created in a requirement",
            )
        instance = build(cls, specifiers, mode_2d=self._context.mode_2d)
        if self._context.evaluating or self._context.judging:
            return instance
        if isinstance(instance, Object):
            instance.__dict__["behavior"] = per_option(instance.behavior, behavior_of)
        sightings = [specifier.sighting for specifier in specifiers if specifier.sighting is not None]
        if self._run is not None:
            context = self._context
            for sighting in sightings if is_always_present(instance) else ():
                is_visible = sees_in_mode(
                    sighting.observer, instance, context.present, mode_2d=context.mode_2d
                )
                if bool(is_visible) != sighting.wanted:
                    raise RejectionException(f"whether the {cls.__name__} is seen")
            self._run.create(instance)
            return instance
        self._program.sightings += [(instance, sighting) for sighting in sightings]
        self._program.instances.append(instance)
        if isinstance(instance, Object):
            self._program.objects.append(instance)
        self._program.places[id(instance)] = (here(), self._module.filename)
        assemble = getattr(cls, "_assembled", None)
        if assemble is not None:
            # The class makes further objects, which belong to this one.
            try:
                assemble(instance)
            except Located as error:
                error.at(self._program.places[id(instance)])
                raise
        return instance

    def property(
        self, name: str, attributes: Sequence[str], value: Callable[[Any], Any], reads: Sequence[str]
    ) -> PropertyDefinition:
        """Return one property definition of a class."""
        assert set(attributes) <= ATTRIBUTES, attributes
        if name == "heading" and self._context.mode_2d:
            return PropertyDefinition(
                "parentOrientation",
                frozenset(attributes),
                lambda instance: to_orientation(value(instance)),
                tuple(reads),
                here(),
            )
        return PropertyDefinition(name, frozenset(attributes), value, tuple(reads), here())

    # Operators

    def operation(self, name: str, *operands: Any) -> Any:
        """One of the language's own operators."""
        function = OPERATORS.get(name)
        if function is not None:
            return function(self._ego, *operands)
        if name == "initial scenario":
            run = self._run
            return self._context.is_symbolic if run is None else run.in_first_setup
        raise UnsupportedError(f"the operator `{name}` is not supported yet", span=here())

    def convert(self, name: str, *args: Any) -> Any:
        """Evaluate ``int(x)``, ``float(x)`` or ``str(x)``."""
        return convert(name, *args)

    def spread(self, function: Any, parts: Sequence[tuple[bool, Any]], keywords: Mapping[str, object]) -> Any:
        """Evaluate ``function(a, *b, k=c)``; ``parts`` marks the starred arguments."""
        return spread(function, parts, keywords)

    sliceable = staticmethod(sliceable)

    # Statements

    def param(self, values: Mapping[str, object]) -> None:
        """Execute ``param name = value, ...``."""
        if self._context.evaluating or not self._context.is_symbolic:
            raise InvalidScenarioError(
                "parameters cannot be set here",
                span=here(),
                help="set them where the program describes the scenario, outside of requirements and simulations",
            )
        program = self._program
        for name, value in values.items():
            definite(value, f"parameter {name!r}")
            if name in program.overrides:
                program.parameters[name] = program.overrides[name]
            elif not (self._module.is_model and name in program.parameters):
                program.parameters[name] = value
                if not self._module.is_model:
                    self._context.parameters.places[name] = self._context.place(), self._context.file()

    def model(self, name: str, scope: dict[str, Any]) -> None:
        """Execute ``model name``: define everything that the module defines, with its parameters as defaults."""
        if self._module.is_model:
            raise InvalidScenarioError("a model cannot itself use `model`", span=here())
        self._context.parameters.model_place = self._context.place(), self._context.file()
        self._modules.use_model(name, scope, self._module)

    def assigned(self, owner: object, name: str) -> None:
        """Check the property that ``owner.name = value`` has just set on an instance of the program, as ``with`` does."""
        if isinstance(owner, Point) and self._run is None and self._context.sample is None:
            check_assigned(owner, name, mode_2d=self._context.mode_2d)
            if name == "behavior" and isinstance(owner, Object):
                owner.__dict__[name] = per_option(owner.behavior, behavior_of)

    def mutate(self, targets: Sequence[Any] | None = None, scale: object = 1) -> None:
        """Execute ``mutate a, b by scale``; without targets it mutates all objects so far."""
        if self._context.evaluating:
            raise InvalidScenarioError(
                "a requirement cannot mutate objects", span=here(), help="mutate them before or after it"
            )
        run = self._run
        if targets is not None:
            instances = targets
        else:
            instances = self._program.objects if run is None else run.current.objects
        mutation.request(instances, scale)
        if run is not None:
            run.check_mutable(instances)

    def simulator(self, make: Callable[[], Any]) -> None:
        """Store the expression of ``simulator expr``, which is evaluated when a simulator is needed."""
        self._program.simulator = make

    def require(self, condition: Condition, *, probability: float | None = None, name: object = None) -> None:
        """Execute ``require condition``: record the condition while the program is compiled, check or follow it during a simulation."""
        if self._context.evaluating:
            raise InvalidScenarioError(
                "a requirement cannot contain another one",
                span=here(),
                help="return the condition, and join conditions with `and`",
            )
        span = here()
        label = label_of(name) or (f"requirement on line {span.line}" if span else "requirement")
        formula = required(condition.tree, label, span, self._module.filename)
        if probability not in (None, 1) and is_temporal(formula.formula):
            raise InvalidScenarioError(
                "a temporal requirement cannot have a probability",
                span=span,
                help="leave out the probability, or the temporal operators",
            )
        chance = 1.0 if probability is None else probability
        if not self._context.is_symbolic:
            self._require_now(formula, chance)
            return
        assert condition.build is not None
        self._program.requirements.append(
            Requirement(
                condition.build(), chance, label, span, self._module.filename, condition.build, formula
            )
        )

    # Conditions

    def condition(
        self,
        symbolic: Callable[..., Any] | None,
        concrete: Callable[..., Any],
        captured: Sequence[object],
        margin: Callable[..., Any] | None = None,
        *,
        awaits: bool = False,
        indices: conditions.Indices | None = None,
    ) -> Condition:
        """Return a leaf of a condition; see `scenic.runtime.description.conditions`.

        One that ``awaits`` reads names that the module sets later. ``indices`` tells which items it reads of what is captured.
        """
        closure = Closure(concrete, captured, margin)
        symbolic_context = self._context.is_symbolic
        self._context.record.awaits |= awaits
        build = (
            conditions.leaf(symbolic, concrete, captured, awaits=awaits, indices=indices)
            if symbolic_context
            else None
        )
        return Condition(closure, build)

    def conjunction(self, *parts: Condition) -> Condition:
        """Join conditions by ``and``."""
        return conditions.connected("and", parts)

    def disjunction(self, *parts: Condition) -> Condition:
        """Join conditions by ``or``."""
        return conditions.connected("or", parts)

    def negation(self, part: Condition) -> Condition:
        """Negate a condition."""
        return conditions.negated(part)

    def temporal(self, operator: str, *parts: Condition) -> Condition:
        """Return a temporal operator, or ``implies``."""
        return conditions.in_time(operator, parts)

    presence = staticmethod(conditions.presence)


class Loader:
    """Runs the modules of one compilation, each afresh.

    Args:
        modules: finds and compiles files of Scenic code.
        context: how the program is being read.
        program: what the modules produce.
        model: replaces the module of every ``model`` statement.

    """

    def __init__(
        self, modules: ModuleCompiler, context: Context, program: Program, *, model: str | None = None
    ) -> None:
        self._modules = modules
        self._context = context
        self._program = program
        self._model = model
        self._folder = "."
        self._loaded: dict[Path, ModuleType] = {}
        self._states: dict[Path, RunningModule] = {}
        self._packages: dict[str, ModuleType] = {}
        self._python: dict[str, ModuleType] = {}

    @property
    def loaded(self) -> Iterable[ModuleType]:
        """The modules that have been imported."""
        return self._loaded.values()

    def run(
        self, code: CodeType, filename: str, scope: Mapping[str, Any] | None = None
    ) -> tuple[ModuleType, RunningModule]:
        """Run the code of a file as a module, with these globals to begin with."""
        state = RunningModule(filename)
        self._folder = str(Path(filename).parent)
        module = ModuleType("__main__")
        vars(module).update(scope or {})
        self._execute(code, module, state)
        return module, state

    def _execute(self, code: CodeType, module: ModuleType, state: RunningModule) -> None:
        prelude = Prelude(self._context, self._program, state, self)
        scope = state.scope = module.__dict__
        scope[PRELUDE] = prelude
        scope["__file__"] = state.filename
        scope["__builtins__"] = names.builtin_names(
            self._program, state.filename, partial(self._import, state)
        )
        if may_mutate(code):
            self._context.stand_ins.make = stand_in
        if not isinstance(current.get(), RunContext):
            self._program.scopes.append(scope)
        exec(code, scope)

    def _import(
        self,
        importer: RunningModule,
        name: str,
        globals: Mapping[str, Any] | None = None,
        locals: Mapping[str, Any] | None = None,
        fromlist: Sequence[str] | None = (),
        level: int = 0,
    ) -> Any:
        """Import for generated modules as ``__import__`` does: Scenic modules first, then Python's."""
        if level:
            base = importer.package.rsplit(".", level - 1)[0] if level > 1 else importer.package
            name = f"{base}.{name}".strip(".") if base else name
        path = self._modules.find(name) if name else None
        if path is None:
            return self._import_python(importer, name, globals, locals, fromlist or (), level)
        module = self._load(path, name, importer)
        for item in fromlist or ():
            # As in Python, modules of a package are among its attributes once somebody has imported them from it.
            if (
                not hasattr(module, item)
                and (module_path := self._modules.find(f"{name}.{item}")) is not None
            ):
                setattr(module, item, self._load(module_path, f"{name}.{item}", importer))
        if fromlist:
            return module
        # `import a.b` binds `a`, by whose attributes all modules are found that are imported so.
        while "." in name:
            name, _, last = name.rpartition(".")
            package = self._package(name, importer)
            setattr(package, last, module)
            module = package
        return module

    def _package(self, name: str, importer: RunningModule) -> ModuleType:
        """Return the module of a package: that of its file, or else one that only leads to its parts."""
        path = self._modules.find(name)
        if path is not None and (path.stem == "__init__" or path in self._loaded):
            return self._load(path, name, importer)
        if name not in self._packages:
            self._packages[name] = ModuleType(name)
            # So it is known as one of the program's, whose values are sampled.
            vars(self._packages[name])[PRELUDE] = importer.scope[PRELUDE]
            self._join(name)
        return self._present(self._packages[name])

    def _join(self, name: str) -> None:
        """Let a package that leads to modules of Scenic lead to what Python finds in it, too."""
        if name in self._packages and name in self._python:
            vars(self._packages[name])["__getattr__"] = partial(getattr, self._python[name])

    @staticmethod
    def _present(module: ModuleType) -> ModuleType:
        """The module in the sample, or the running simulation, whose code imports it."""
        sample = sample_of(sys._getframe(1))
        own: ModuleType = module if sample is None else sample.value(module)
        return own

    def _import_python(
        self,
        importer: RunningModule,
        name: str,
        globals: Mapping[str, Any] | None,
        locals: Mapping[str, Any] | None,
        fromlist: Sequence[str],
        level: int,
    ) -> Any:
        """Return a module of Python, or a folder some of whose modules are Scenic's."""
        folder = Path(self._folder)
        parts = {item: path for item in fromlist if (path := self._modules.find(f"{name}.{item}".strip(".")))}
        others = [item for item in fromlist if item not in parts]
        if not parts or others:
            forget_stranger(name, folder)
            for item in (name, *(f"{name}.{part}" for part in others)):
                note_import(item)
            with beside(folder):
                module = builtins.__import__(
                    name, globals, locals, others, 0 if importer.package or not level else level
                )
            if not parts:
                if fromlist:
                    return module
                for package in accumulate(name.split("."), "{}.{}".format):
                    self._python[package] = sys.modules[package]
                    self._join(package)
                top = module.__name__
                return self._present(self._packages[top]) if top in self._packages else module
        holder = ModuleType(name)
        if others:
            vars(holder).update(vars(module))
        for item, path in parts.items():
            setattr(holder, item, self._load(path, f"{name}.{item}".strip("."), importer))
        return holder

    def _load(self, path: Path, name: str, importer: RunningModule, *, is_model: bool = False) -> ModuleType:
        active = current.get()
        modules = self._loaded
        if isinstance(active, RunContext) and path not in modules:
            modules = active.run.modules
        note_file(path)
        if path not in modules:
            module = ModuleType(name)
            modules[path] = module
            if isinstance(active, RunContext):
                active.run.copies.adopt(module)
            package = name if path.stem == "__init__" else name.rpartition(".")[0]
            state = self._states[path] = RunningModule(
                str(path), is_model=is_model or importer.is_model, package=package
            )
            self._execute(self._modules.code(path), module, state)
        if not isinstance(active, RunContext):
            state = self._states[path]
            if importer.ego is None:
                importer.ego = state.ego
            if importer.workspace is None:
                importer.workspace = state.workspace
        return self._present(modules[path])

    def use_model(self, name: str, scope: dict[str, Any], importer: RunningModule) -> None:
        """Give a module everything that a model defines."""
        model_name = self._model or name
        path = self._modules.find(model_name)
        if path is None:
            raise InvalidScenarioError(
                f"there is no world model {model_name!r}",
                code="SC406",
                span=here(),
                help=how_to_get(model_name),
            )
        module = self._load(path, model_name, importer, is_model=True)
        public = getattr(module, "__all__", None)
        scope.update(
            (key, value)
            for key, value in vars(module).items()
            if (key in public if public is not None else not key.startswith("_"))
        )


__all__ = ["Condition", "Loader", "ModuleCompiler", "Prelude"]
