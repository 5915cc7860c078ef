"""Scenes: one sample of a scenario."""

import pickle
import sys
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, TextIO

from scenic.dataclass import dataclass
from scenic.graph.node import Node
from scenic.language.spans import Span
from scenic.runtime.description.declarations import Copier
from scenic.runtime.description.outcome import Program, Requirement
from scenic.runtime.ground.files import whole
from scenic.runtime.instances.objects import Object, Point
from scenic.runtime.python.samples import dependencies
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.spaces import Workspace
from scenic.runtime.sampling.engine import FinishedLanes
from scenic.runtime.sampling.rejection_report import Approximation
from scenic.runtime.scenes.dumping import program_of
from scenic.runtime.scenes.pickled_values import ValueLayout
from scenic.runtime.scenes.population import Populations


@dataclass(frozen=True, slots=True)
class Origin:
    """The description of an object in all scenes of its program.

    ``names`` are its properties, ``given`` those that the program gives, ``fixed`` those that are the same in every scene.
    """

    names: tuple[str, ...]
    given: tuple[str, ...]
    fixed: frozenset[str]

    @classmethod
    def of(cls, instance: Point) -> "Origin":
        """Return the origin of an instance of the program."""
        values = instance.__dict__
        # What is in a scene is present there.
        names = tuple(sorted({*values.get("_names", instance.scenic_properties)} - {"present"}))
        mutable = bool(dependencies([values.get("mutationScale")])) or values.get("mutationScale") != 0
        fixed = () if mutable else (name for name in names if not dependencies([values.get(name)]))
        given = sorted({*values.get("_given", names)} - {"present"})
        return cls(names, tuple(given), frozenset(fixed))

    def read(self, thing: object, name: str) -> Any:
        """Return the value of a property in one scene."""
        return getattr(thing, name)


@dataclass(frozen=True, slots=True)
class SceneFamily:
    """The common ground of all scenes of a scenario.

    ``populations`` makes their objects, ``names`` are the variables that hold these, by the identities of the program's.
    ``keep`` gives a scene as data, ``layout`` the values in its pickle.
    """

    program: Program
    ego: Object | None
    populations: Populations
    workspace: Workspace
    names: Mapping[int, str]
    digest: Callable[[], str]
    keep: Callable[["Scene"], bytes]
    layout: ValueLayout
    scenario: Any
    regions: Mapping[str, Region]


class Scene:
    """Concrete objects and parameters. Values are read from the sample on first use.

    It has few attributes, since many scenes are made; ``family`` contains the data that all scenes of a scenario share.
    """

    _sample: Copier | None = None
    _cast: tuple[Any, ...] | None = None
    _objects: tuple[Any, ...] | None = None
    _params: dict[str, Any] | None = None
    _pickled: tuple[bytes, bytes, bytes] | None = None

    def __init__(self, found: FinishedLanes, lane: int, family: SceneFamily) -> None:
        self.found = found
        self.lane = lane
        self._family = family

    @property
    def seed(self) -> int:
        """Seed of the run that made the scene."""
        return self.found.seeds[self.lane]

    @property
    def k(self) -> int:
        """Number of the scene in that run, from 0; with `seed` it determines the scene."""
        return self.found.numbers[self.lane]

    @property
    def attempts(self) -> int:
        """Candidates tried until this one was accepted, itself included; of several components the largest number."""
        return self.found.attempts[self.lane]

    @property
    def component_attempts(self) -> tuple[int, ...]:
        """Candidates tried of each independent component of the scene."""
        components = self.found.components
        return (self.attempts,) if components is None else tuple(components[self.lane].tolist())

    @property
    def approximation(self) -> Approximation | None:
        """The making of the scene together with others, if it is an approximate one (`Scenario.stream`)."""
        return self.found.approximation

    @property
    def workspace(self) -> Workspace:
        """The region that contains all objects."""
        return self._family.workspace

    @property
    def scenario(self) -> Any:
        """The `Scenario` that the scene was made of."""
        return self._family.scenario

    @property
    def digest(self) -> str:
        """The digest of the program in saved scenes."""
        return self._family.digest()

    def lookup(self, node: Node) -> Any:
        """Return the value of a node in this scene."""
        return self.found.batch.value(node, self.lane)

    @property
    def folder(self) -> Path:
        """The folder of the program, where its paths of files start."""
        return Path(self.scenario.filename).absolute().parent

    @property
    def dimension(self) -> int:
        """Number of axes of the unit cube that scenes of the program are drawn from."""
        return self.found.batch.graph.dimension

    @property
    def sources(self) -> tuple[Object, ...]:
        """The objects of the program of which `cast` are samples."""
        return self._family.populations.objects

    @property
    def program(self) -> Program:
        """The program that the scene is a sample of."""
        return self._family.program

    def enforces(self, requirement: Requirement) -> bool:
        """Return whether a requirement of the program is among those that the scene has to meet: soft ones may not be."""
        if requirement.probability == 1:
            return True
        soft = [item for item in self.program.requirements if item.probability < 1 and not _always(item)]
        if requirement not in soft:
            return True
        return self.found.is_active(self.lane, soft.index(requirement), requirement.probability)

    def within(self, copies: Copier) -> "Scene":
        """The same scene over other copies of its values, as a simulation changes them."""
        scene = self.__copy__()
        scene._sample = copies
        scene._cast = scene._objects = scene._params = None
        return scene

    @property
    def objects(self) -> tuple[Any, ...]:
        """All objects that are present: the ego first, then the others in order of creation."""
        if self._objects is None:
            cast = self.cast
            missing = self._missing()
            self._objects = (
                tuple(item for place, item in enumerate(cast) if place not in missing) if missing else cast
            )
        return self._objects

    @property
    def cast(self) -> tuple[Any, ...]:
        """An object for each of the program's `objects`, also for objects that are not present in this scene."""
        if self._cast is None:
            sample = self._values()
            if self._cast is None:
                self._cast = tuple(map(sample.value, self._family.populations.objects))
        return self._cast

    def _missing(self) -> frozenset[int]:
        """The places in `cast` of objects that take no part."""
        populations = self._family.populations
        return populations.missing(self.found, self.lane) if populations.optional else frozenset()

    def _values(self) -> Copier:
        """Return the values of the program in this scene."""
        if self._sample is None:
            # Scenes of a batch have their objects made together.
            population = self._family.populations.of(self.found)
            self._sample, self._cast = population.take(self.lane)
        return self._sample

    def place(self, number: int) -> tuple[Span | None, str | None]:
        """Return the span and file where the program creates the object of a number, each ``None`` if unknown."""
        missing = self._missing()
        taking_part = [item for place, item in enumerate(self.sources) if place not in missing]
        return self.program.places.get(id(taking_part[number]), (None, None))

    @property
    def egoObject(self) -> Any:
        """The ego, or ``None``."""
        return None if self._family.ego is None else self.objects[0]

    @property
    def params(self) -> dict[str, Any]:
        """Values of the global parameters."""
        if self._params is None:
            sample = self._values()
            self._params = {name: sample.value(value) for name, value in self.program.parameters.items()}
        return self._params

    @property
    def names(self) -> dict[Any, str]:
        """The variable of the program that refers to each object, if any."""
        return {
            item: name
            for item in self.objects
            if (name := self._family.names.get(id(item.__dict__.get("_source")))) is not None
        }

    @property
    def regions(self) -> dict[str, Region]:
        """The regions in variables of the program, by name, with their values in this scene."""
        sample = self._values()
        return {name: sample.value(region) for name, region in self._family.regions.items()}

    def origin(self, thing: Any) -> Origin:
        """Return the description of an object of the scene in all scenes of the program."""
        source = thing.__dict__.get("_source", thing)
        known = source.__dict__.get("_origin")
        if known is None:
            known = source.__dict__["_origin"] = Origin.of(source)
        origin: Origin = known
        return origin

    def __reduce__(self) -> tuple[Any, ...]:
        """A scene is pickled as its program, which a process compiles once for all of its scenes, its draws and its values."""
        if self._pickled is not None:
            return _taken_up, (type(self), *self._pickled)
        family = self._family
        values = family.layout.pack(self.found.batch, self.lane)
        return _taken_up, (type(self), family.scenario.recipe_bytes, family.keep(self), values)

    def __getattr__(self, name: str) -> Any:
        """Read the data of a scene that was unpickled, when it is first looked at."""
        if name not in _EVALUATED or self._pickled is None:
            raise AttributeError(
                f"'{type(self).__name__}' object has no attribute {name!r}", name=name, obj=self
            )
        recipe, data, values = self._pickled
        scene = _compiled(recipe).recalled(data, values)
        self.found, self.lane, self._family = scene.found, scene.lane, scene._family
        return self.__dict__[name]

    def __copy__(self) -> "Scene":
        scene = object.__new__(type(self))
        scene.__dict__.update(self.__dict__)
        return scene

    def __deepcopy__(self, _memo: object) -> "Scene":
        """The same scene with objects of its own."""
        scene = self.__copy__()
        scene._sample = scene._cast = scene._objects = scene._params = None
        return scene

    def save(self, path: str | Path) -> None:
        """Write the scene to a file, which `Scenario.replay` reads; the file is complete or absent."""
        content = self._family.keep(self)
        with whole(Path(path)) as stream:
            stream.write(content)

    def dump(self) -> str:
        """Return a program whose only scene is this one: concrete objects, no requirements."""
        return program_of(self.objects, self.egoObject, self.params, self.names)

    def dumpAsScenicCode(self, stream: TextIO | None = None) -> None:
        """Write `dump` to a stream (standard output by default)."""
        (sys.stdout if stream is None else stream).write(self.dump())

    def __repr__(self) -> str:
        return f"<Scene {self.k} of seed {self.seed}: {len(self.objects)} objects>"


def _always(requirement: Requirement) -> bool:
    """Return whether a requirement needs no check, since it holds in every scene."""
    return requirement.condition.is_constant and bool(requirement.condition.value)


def _taken_up(cls: type[Scene], recipe: bytes, data: bytes, values: bytes) -> Scene:
    """The scene of its draws and values, with objects of its own; they are read when it is first looked at."""
    scene = object.__new__(cls)
    scene._pickled = recipe, data, values
    return scene


_EVALUATED: Final = frozenset({"found", "lane", "_family"})
"""Attributes that an unpickled scene gets when it is first looked at."""


@lru_cache(maxsize=16)
def _compiled(recipe: bytes) -> Any:
    """Return the scenario of a pickled recipe, for all scenes of it that this process takes up."""
    make, arguments = pickle.loads(recipe)
    return make(*arguments)
