"""``scenic map``: what is in a road map, and drawings of it."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from scenic.cli.options import PATH, option
from scenic.cli.output import CLEAN, has_colours
from scenic.cli.sinks import OutputChoiceError

if TYPE_CHECKING:
    from scenic.domains.driving.roads import Network

__all__ = ["map_command"]


@click.command("map")
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
@option("-o --output OUT", "Draw the map from above: OUT ends in .svg or .png.", PATH)
@option("--width PIXELS", "Of the drawing.", click.IntRange(min=50), default=1600)
def map_command(file: Path, output: Path | None, width: int) -> int:
    """Show the contents of a road map, or draw it.

    `scenic check FILE` lists the problems of the map.
    """
    from scenic.domains.driving.drawing import png, svg
    from scenic.formats.files import check_writable, write

    if output is not None:
        check_writable(output)
        if output.suffix.lower() not in (".svg", ".png"):
            raise OutputChoiceError(
                f"maps are not drawn as {output.suffix or 'a file without an ending'}",
                help="give a name that ends in .svg or .png",
            )
    network = _loaded(file)
    if output is not None:
        image = svg(network, width).encode() if output.suffix.lower() == ".svg" else png(network, width)
        write(output, image)
        return CLEAN
    from rich.console import Console
    from rich.table import Table

    table = Table.grid(padding=(0, 2))
    length = sum(road.centerline.length for road in network.roads)
    drivable = network.drivableRegion.area  # type: ignore[attr-defined] # there is at least one road
    for row in (
        (
            "roads",
            f"{len(network.roads)}, {length / 1000:.1f} km, and {len(network.connectingRoads)} in intersections",
        ),
        ("lanes", f"{len(network.lanes)}, {drivable:,.0f} m2 for traffic"),
        ("intersections", _intersections(network)),
        ("roundabouts", _roundabouts(network)),
        ("speeds", _speeds(network)),
        ("signals", _signals(network)),
        ("sidewalks", str(len(network.sidewalks))),
        ("crossings", _crossings(network)),
        ("shoulders", str(len(network.shoulders))),
        ("traffic", "keeps left" if network.driveOnLeft else "keeps right"),
        ("problems", f"{len(network.problems)} (scenic check {file})" if network.problems else "none"),
    ):
        table.add_row(*row)
    Console(no_color=not has_colours(sys.stdout), highlight=False).print(table)
    return CLEAN


def _speeds(network: "Network") -> str:
    """The speed limits of ordinary roads, and the length of road with each of them."""
    lengths: dict[float | None, float] = {}
    for road in network.roads:
        for start, stop, limit in road.speedLimitRanges:
            lengths[limit] = lengths.get(limit, 0.0) + stop - start
    rows = sorted(lengths.items(), key=lambda item: (item[0] is None, item[0] or 0.0))
    return ", ".join(
        f"{'no limit' if limit is None else f'{3.6 * limit:.0f} km/h'} on {length / 1000:.1f} km"
        for limit, length in rows
    )


def _intersections(network: "Network") -> str:
    """The number of intersections, and of those with lights."""
    lights = sum(any(signal.isTrafficLight for signal in item.signals) for item in network.intersections)
    return f"{len(network.intersections)}, {lights} with traffic lights"


def _roundabouts(network: "Network") -> str:
    """The places, radii and roads of roundabouts."""
    from scenic.domains.driving.roundabouts import roundabouts

    found = roundabouts(network)
    shown = [
        f"radius {item.radius:.0f} m at ({round(item.center[0])}, {round(item.center[1])}) with {item.arms} roads"
        for item in found
    ]
    return f"{len(found)}: {'; '.join(shown)}" if shown else "none"


def _crossings(network: "Network") -> str:
    """The number of crossings, and of those in intersections."""
    from scenic.domains.driving.roads import Intersection

    inside = sum(isinstance(item.parent, Intersection) for item in network.crossings)
    return f"{len(network.crossings)}, {inside} of them in intersections" if network.crossings else "none"


def _signals(network: "Network") -> str:
    """Numbers of lights and signs, and of the maneuvers that they hold for."""
    kinds = {
        "traffic lights": "isTrafficLight",
        "stop signs": "isStopSign",
        "signs to give way": "isYieldSign",
        "speed limits": "isSpeedLimit",
    }
    counts = {name: sum(getattr(item, kind) for item in network.signals) for name, kind in kinds.items()}
    others = len(network.signals) - sum(counts.values())
    phrases = [f"{count} {name}" for name, count in (*counts.items(), ("others", others)) if count]
    if not phrases:
        return "none"
    maneuver_count = sum(maneuver.signal is not None for maneuver in network.maneuvers)
    return f"{', '.join(phrases)}; they hold for {maneuver_count} of {len(network.maneuvers)} maneuvers"


def _loaded(file: Path) -> "Network":
    from scenic.domains.driving.roads import Network

    try:
        return Network.fromFile(file)
    except (OSError, ValueError) as error:
        raise OutputChoiceError(str(error), help="give an OpenDRIVE file") from error
