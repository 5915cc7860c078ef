"""From a map file to its network."""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, TypeVar

from scenic.dataclass import dataclass
from scenic.domains.driving.building import LaneTypes, build_roads
from scenic.domains.driving.crossings import add_crossings
from scenic.domains.driving.elevation import Elevation, RoadHeight
from scenic.domains.driving.linking import link_roads
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.storing import KIND, restored, stored
from scenic.formats.opendrive.problems import told
from scenic.formats.opendrive.reader import read_map
from scenic.formats.opendrive.records import MapProblem
from scenic.formats.opendrive.sampled_lanes import MAX_ERROR
from scenic.formats.opendrive.xml_tree import MapError
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.garbage import no_garbage_collection
from scenic.language.spans import Span
from scenic.language.spelling import nearest
from scenic.runtime.geometry.store import Arrays, kept
from scenic.runtime.ground.used_files import note_file

__all__ = ["MapOptions", "load_network", "map_file", "network_of"]

SUFFIX: Final = ".xodr"

_Network = TypeVar("_Network", bound=RoadNetwork)


@dataclass(frozen=True, slots=True)
class MapOptions:
    """Options by which a map becomes a network (the parameter ``map_options``).

    Attributes:
        tolerance: metres within which an element counts as being at a place that none holds.
        ref_points: samples of each piece of a reference line, at least; accuracy comes from ``max_error``.
        max_error: metres by which chords may deviate from curves.
        fill_gaps: whether to join linked lanes across small gaps.
        fill_intersections: whether to fill holes inside intersections.
        elide_short_roads: accepted; roads without area are always left out.
        drivable_lane_types: types of lanes for traffic.
        sidewalk_lane_types: types of lanes that are sidewalks.
        shoulder_lane_types: types of lanes that are shoulders.
        useCache: whether a network that was kept may be used.
        writeCache: whether to keep the network.

    """

    tolerance: float = 0.05
    ref_points: int = 2
    max_error: float = MAX_ERROR
    fill_gaps: bool = True
    fill_intersections: bool = True
    elide_short_roads: bool = False
    drivable_lane_types: frozenset[str] = LaneTypes().drivable
    sidewalk_lane_types: frozenset[str] = LaneTypes().sidewalk
    shoulder_lane_types: frozenset[str] = LaneTypes().shoulder
    useCache: bool = True
    writeCache: bool = True

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> "MapOptions":
        """Return the options of a mapping; raises ``TypeError`` for unknown names."""
        known = [field.name for field in fields(cls)]
        for name in given:
            if name not in known:
                near = nearest(name, known)
                hint = f"did you mean {near!r}?" if near else f"the options are {', '.join(known)}"
                raise TypeError(f"a map has no option {name!r}: {hint}")
        lanes = {name: frozenset(value) for name, value in given.items() if name.endswith("_types")}
        return cls(**{**given, **lanes})

    def key(self) -> bytes:
        """Return the options that decide about the network, as bytes that are the same in each run."""
        shown = [
            (field.name, sorted(value) if isinstance(value, frozenset) else value)
            for field in fields(self)
            if "Cache" not in field.name
            for value in [getattr(self, field.name)]
        ]
        return repr(shown).encode()

    @property
    def types(self) -> LaneTypes:
        """The types of lanes."""
        return LaneTypes(self.drivable_lane_types, self.sidewalk_lane_types, self.shoulder_lane_types)


def load_network(
    path: object, given: Mapping[str, object], cls: type[_Network], elevated: bool = False
) -> _Network:
    """The network of a map file, of a class; see `Network.fromFile`."""
    options = MapOptions.of(given)
    file = map_file(path)
    note_file(file)
    with no_garbage_collection():
        network = network_of(file.read_bytes(), str(file), options, cls, elevated)  # type: ignore[arg-type] # classes can be hashed
    assert isinstance(network, cls)
    return network


def map_file(path: Any) -> Path:
    """The file of a map, whose suffix may be left out.

    Raises:
        FileNotFoundError: if there is none.
        IsADirectoryError: if it is a folder.
        ValueError: if its name tells of a format that is not read.

    """
    file = Path(path)
    if not file.suffix and not file.is_file() and file.with_suffix(SUFFIX).is_file():
        file = file.with_suffix(SUFFIX)
    if file.is_dir():
        raise IsADirectoryError(f"'{file}' is a folder, not a map: give the .xodr file")
    if file.suffix and file.suffix.lower() != SUFFIX:
        raise ValueError(f"'{file}' is not a map that scenic reads: it reads OpenDRIVE, {SUFFIX} files")
    if not file.is_file():
        beside = sorted(item.name for item in file.parent.glob(f"*{SUFFIX}")) if file.parent.is_dir() else []
        hint = f"; there are {', '.join(beside[:8])}" if beside else ""
        raise FileNotFoundError(f"there is no map '{file}'{hint}")
    return file


@lru_cache(maxsize=8)
def network_of(
    content: bytes,
    filename: str,
    options: MapOptions,
    cls: type[RoadNetwork] = RoadNetwork,
    elevated: bool = False,
) -> RoadNetwork:
    """The network of the text of a map, in space if ``elevated``; once in a process for equal content and options.

    Raises `MapError` if it is not a map, or has no lane for traffic.
    """
    network = _found(content, filename, options, cls)
    network.is_elevated = elevated
    return network


def _found(content: bytes, filename: str, options: MapOptions, cls: type[RoadNetwork]) -> RoadNetwork:
    """Return a network that was kept, or is built."""
    if not (options.useCache or options.writeCache):
        return _build(content, filename, options, cls)
    networks: list[RoadNetwork] = []

    def build() -> Arrays:
        networks.append(_build(content, filename, options, cls))
        return stored(networks[0])

    key = hashlib.sha256(_code() + options.key() + content).digest()
    arrays = kept(KIND, key, build, read=options.useCache, write=options.writeCache)
    try:
        network = networks[0] if networks else restored(arrays, filename, options.tolerance, cls)
        network.origin = key
        return network
    except (LookupError, TypeError, ValueError):
        # The file is whole, but not one that this version wrote.
        return _build(content, filename, options, cls)


def _code() -> bytes:
    """The digest of the modules that decide about networks: one that other code made is never used."""
    here = Path(__file__).parent
    folders = (here, here.parents[1] / "formats" / "opendrive")
    digest = hashlib.sha256()
    for file in sorted(file for folder in folders for file in folder.glob("*.py")):
        digest.update(file.read_bytes())
    return digest.digest()


def _build(content: bytes, filename: str, options: MapOptions, cls: type[RoadNetwork]) -> RoadNetwork:
    """The network of the text of a map."""
    records = read_map(content, filename)
    problems = list(records.problems)
    tell: Callable[[MapProblem], None] = problems.append
    left = sum(road.left_hand for road in records.roads) * 2 > len(records.roads)
    network = cls(tolerance=options.tolerance, driveOnLeft=left)
    network.offset = records.offset
    roads = build_roads(
        network,
        records,
        tell,
        types=options.types,
        max_error=options.max_error,
        min_points=max(2, options.ref_points),
    )
    if not any(road.road.lanes for road in roads.values()):
        raise MapError(
            "the map has no lane for traffic",
            filename=filename,
            span=Span(1, 0, 1, 1),
            help="types of lanes for traffic can be given by the option `drivable_lane_types`",
        )
    link_roads(
        network,
        records,
        roads,
        tell,
        fill_gaps=options.fill_gaps,
        fill_intersections=options.fill_intersections,
    )
    add_crossings(network, roads, tell)
    network._elevation = Elevation(
        [
            RoadHeight(
                road.road.uid,
                road.shape.samples,
                road.record.elevation,
                road.record.superelevation,
                road.record.crossfall,
                road.record.shapes,
            )
            for road in roads.values()
        ]
    )
    network.problems = tuple(_diagnostic(problem, filename) for problem in told(tuple(problems)))
    return network


def _diagnostic(problem: MapProblem, filename: str) -> Diagnostic:
    span = Span(problem.line, 0, problem.line, 1) if problem.line > 0 else None
    return Diagnostic(problem.code, problem.message, span, Severity.WARNING, filename)
