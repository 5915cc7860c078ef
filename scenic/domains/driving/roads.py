"""Road networks and their elements: the names that programs import."""

from pathlib import Path
from typing import Any, ClassVar
from zipfile import BadZipFile

import numpy as np

from scenic.domains.driving.drawing import show, svg
from scenic.domains.driving.elements import (
    Intersection,
    Lane,
    LaneGroup,
    LaneSection,
    LinearElement,
    Maneuver,
    NetworkElement,
    PedestrianCrossing,
    Road,
    RoadSection,
    Shoulder,
    Sidewalk,
    Signal,
)
from scenic.domains.driving.enumerations import ManeuverType, VehicleType
from scenic.domains.driving.loading import load_network
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.storing import KIND, restored, stored
from scenic.runtime.ground.files import whole

__all__ = [
    "Intersection",
    "Lane",
    "LaneGroup",
    "LaneSection",
    "LinearElement",
    "Maneuver",
    "ManeuverType",
    "Network",
    "NetworkElement",
    "PedestrianCrossing",
    "Road",
    "RoadSection",
    "Shoulder",
    "Sidewalk",
    "Signal",
    "VehicleType",
]


class Network(RoadNetwork):
    """The road network of a map."""

    pickledExt: ClassVar[str] = ".snet"
    """The established ending of files that `dumpPickle` writes. They hold arrays alone; no such file is read unless it is named."""

    class DigestMismatchError(ValueError):
        """A kept network is not one of this map."""

    @classmethod
    def fromFile(
        cls,
        path: object,
        useCache: bool = True,
        writeCache: bool = True,
        elevated: bool = False,
        **options: Any,
    ) -> "Network":
        """The network of a map file; the same one for equal content and options.

        Args:
            path: an OpenDRIVE file; ``.xodr`` may be left out.
            useCache: whether a network that was kept may be used.
            writeCache: whether to keep the network.
            elevated: whether its elements are surfaces in space, with the heights of the map, and not of the plane.
            options: see `scenic.domains.driving.loading.MapOptions`.

        Raises:
            FileNotFoundError: if there is no such file.
            ValueError: if its name tells of another format.
            MapError: if it is not a map.

        """
        return load_network(path, {"useCache": useCache, "writeCache": writeCache, **options}, cls, elevated)

    @classmethod
    def fromOpenDrive(cls, path: object, **options: Any) -> "Network":
        """Return the network of an OpenDRIVE file; see `fromFile`."""
        return cls.fromFile(path, **options)

    def dumpPickle(self, path: Any, digest: bytes = b"") -> None:
        """Keep the network in a file, as arrays, with a digest of the map that it is made from."""
        arrays: dict[str, Any] = {**stored(self), "tolerance": np.array(self.tolerance)}
        with whole(Path(path)) as file:
            np.savez_compressed(file, form=np.array(KIND), digest=np.frombuffer(digest, np.uint8), **arrays)

    @classmethod
    def fromPickle(cls, path: Any, originalDigest: bytes | None = None) -> "Network":
        """Return the network in a file that `dumpPickle` wrote. Nothing in the file is executed.

        Args:
            path: the file.
            originalDigest: the digest that it must have been given, if any.

        Raises:
            ValueError: if this version wrote no such file.
            DigestMismatchError: if its digest is another one.

        """
        try:
            with np.load(path, allow_pickle=False) as file:
                arrays = dict(file)
            if str(arrays["form"]) != KIND:
                raise KeyError("form")
            if originalDigest is not None and arrays["digest"].tobytes() != originalDigest:
                raise cls.DigestMismatchError(f"'{path}' is of another map, or of other options")
            return restored(arrays, str(path), float(arrays["tolerance"]), cls)
        except cls.DigestMismatchError:
            raise
        except (LookupError, TypeError, ValueError, BadZipFile) as error:
            raise ValueError(
                f"'{path}' is not a network that this version of scenic wrote: load the map itself"
            ) from error

    def svg(self, width: int = 1200) -> str:
        """Return a drawing of the network from above, as SVG, ``width`` pixels wide."""
        return svg(self, width)

    def show(self, labelIncomingLanes: bool = False, showCurbArrows: bool = False) -> Path:
        """Draw the network in a browser, and return the file; the arguments are accepted for compatibility."""
        return show(self)
