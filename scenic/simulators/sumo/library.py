"""SUMO's packages, which are optional: ``libsumo``, and ``netconvert`` of ``eclipse-sumo``; used where a simulation is made."""

import contextlib
import io
import os
import subprocess
import sys
import warnings
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from scenic.language.errors import SimulationCreationError, UnsupportedError
from scenic.language.extras import installation

__all__ = ["convert", "library"]


def library() -> Any:
    """Return the module ``libsumo``; raises `UnsupportedError` without it. It has no types, hence `Any`."""
    try:
        # It prints a warning about other versions of pyarrow, whose functions are not used here.
        with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of its binding's types
            import libsumo  # optional, and slow to import
    except ImportError as error:
        raise UnsupportedError(
            "the SUMO simulator needs the packages libsumo and eclipse-sumo",
            help=f"install them: {installation('sumo')}; sampling scenes needs neither",
        ) from error
    return libsumo


def convert(road_map: Path, network: Path) -> None:
    """Write SUMO's network of an OpenDRIVE file, in the same coordinates.

    Args:
        road_map: the OpenDRIVE file.
        network: what to write, a ``.net.xml`` file.

    Raises:
        UnsupportedError: ``eclipse-sumo`` is not installed.
        SimulationCreationError: SUMO cannot read the map.

    """
    spec = find_spec("sumo")
    if spec is None or spec.origin is None:
        raise UnsupportedError(
            "the SUMO simulator needs the package eclipse-sumo, which converts maps",
            help=f"install it: {installation('sumo')}",
        )
    home = Path(spec.origin).parent
    program = home / "bin" / ("netconvert.exe" if sys.platform == "win32" else "netconvert")
    process = subprocess.run(
        [
            str(program),
            *("--opendrive-files", str(road_map), "--output-file", str(network)),
            *("--offset.disable-normalization", "true", "--no-warnings", "true"),
        ],
        env={**os.environ, "SUMO_HOME": str(home), "PROJ_DATA": str(home / "data" / "proj")},
        capture_output=True,
        text=True,
        check=False,
    )
    if process.returncode or not network.exists():
        message = next(
            (line for line in process.stderr.splitlines() if line.startswith("Error")), process.stderr.strip()
        )
        raise SimulationCreationError(
            f"SUMO cannot read the map {road_map}: {message}",
            help="the map must be an OpenDRIVE file with roads for cars",
        )
