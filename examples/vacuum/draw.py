"""Draws the floor that the worst simulation of a table has passed over, as SVG.

scenic simulate examples/vacuum/vacuum.scenic -n 25 --seed 1 -p numToys=0,1,2,4,8,16 --keep all --time 1200 --table runs.csv
python examples/vacuum/draw.py runs.csv --seed 1 -o worst.svg
"""

import argparse
import csv
from pathlib import Path

import shapely

import scenic

PROGRAM = Path(__file__).parent / "vacuum.scenic"
COLOURS = {"Wall": "#c9c2b3", "Vacuum": "#343a44", "Toy": "#d9534f", "Block": "#d9534f", "Couch": "#5a6f91"}


def main() -> None:
    """Simulate the worst row again, and draw it."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("table", type=Path)
    options.add_argument("--seed", type=int, required=True, help="the seed of the simulations in the table")
    options.add_argument("-o", "--output", type=Path, default=Path("worst.svg"))
    arguments = options.parse_args()
    rows = list(csv.DictReader(arguments.table.open()))
    worst = min((row for row in rows if row["robustness"]), key=lambda row: float(row["robustness"]))
    print(f"numToys={worst['numToys']}, simulation {worst['k']}: robustness {worst['robustness']}")
    scenario = scenic.load(PROGRAM, params={"numToys": int(worst["numToys"])})
    number = int(worst["k"])
    scene = scenario.sample(number + 1, seed=arguments.seed)[number]
    (run,) = scenario.simulate(1, seed=arguments.seed, first=number, max_steps=1200, keep_violations=True)
    arguments.output.write_text(drawing(scene, [place for _, place in run.about["records"]["path"]]))


def drawing(scene: object, path: list[list[float]]) -> str:
    """The room from above: what was swept, the path, and the things where they stood at the beginning."""
    line = shapely.LineString([place[:2] for place in path])
    ground = [
        shapely.Point(tuple(thing.position)[:2]).buffer(thing.width / 2)
        if thing is scene.egoObject
        else shapely.MultiPoint([tuple(corner)[:2] for corner in thing.corners]).convex_hull
        for thing in scene.objects
    ]
    shapes = [
        _shape(line.buffer(scene.egoObject.width / 2), "fill='#a9d6a3'"),
        f"<polyline points='{_points(line.coords)}' fill='none' stroke='#3c8c4a' stroke-width='.01'/>",
        *(
            _shape(outline, f"fill='{COLOURS.get(type(thing).__name__, '#a77f5a')}' fill-opacity='.75'")
            for thing, outline in zip(scene.objects, ground, strict=True)
        ),
    ]
    return (
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='-2.6 -2.6 5.2 5.2' width='640' height='640'>"
        f"<rect x='-2.6' y='-2.6' width='5.2' height='5.2' fill='white'/>{''.join(shapes)}</svg>"
    )


def _shape(area: shapely.Geometry, style: str) -> str:
    parts = getattr(area, "geoms", [area])
    rings = [ring for part in parts for ring in (part.exterior, *part.interiors)]
    data = " ".join(f"M {_points(ring.coords)} Z" for ring in rings)
    return f"<path d='{data}' fill-rule='evenodd' {style}/>"


def _points(places: shapely.coords.CoordinateSequence) -> str:
    """Places with y upwards as points of SVG, whose y is downwards."""
    return " ".join(f"{place[0]:.3f},{-place[1]:.3f}" for place in places)


if __name__ == "__main__":
    main()
