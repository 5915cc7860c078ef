"""Simulates the crossing, and labels every image of the ego's camera with whether the other car is visible.

python examples/intersection_labels/label.py -n 20 --seed 1 -o labels

makes, in the folder, for each run a film, and a folder of labelled images with an index in the form of the COCO data
sets; ``labels.csv`` (a row for each image), ``runs.csv`` (verdicts of the requirements) and ``moments.png``: images
before, while and after the other car is seen. Needs the extra `video`.
"""

import argparse
import csv
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import PIL.Image
import PIL.ImageDraw

import scenic
from scenic.formats.coco import LabelledImages
from scenic.simulators.cameras import Present

PROGRAM = Path(__file__).parent / "labels.scenic"
CAMERA = "front"
MOST_STEPS = 120


def main() -> None:
    """Make the data set."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("-n", type=int, default=20, help="runs")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("-o", "--output", type=Path, default=Path("labels"))
    arguments = options.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    scenario = scenic.load(PROGRAM, params={"recordFolder": str(arguments.output)})
    rows, runs = [], []
    for scene in scenario.sample(arguments.n, seed=arguments.seed):
        simulation = labelled(scenario, scene, arguments.output / f"images-{scene.k:03d}")
        rows += list(labels(simulation.result.records, scene.k, arguments.output / f"images-{scene.k:03d}"))
        verdicts = {item.label: item.verdict.name.lower() for item in simulation.result.requirements}
        is_satisfied = not any(verdict.endswith("false") for verdict in verdicts.values())
        runs.append({"run": scene.k, **verdicts, "satisfied": is_satisfied})
        print(
            f"run {scene.k}: {simulation.result.records['visible'][-1][0]} steps, satisfied: {is_satisfied}",
            flush=True,
        )
    write(arguments.output / "labels.csv", rows)
    write(arguments.output / "runs.csv", runs)
    print(f"{sum(run['satisfied'] for run in runs)} of {len(runs)} runs satisfy the formula")
    wrong = sum(row["in view"] != row["visible"] for row in rows)
    print(f"{wrong} of {len(rows)} images would be labelled wrongly if nothing could hide the car")
    for run in runs:
        mine = [row for row in rows if row["run"] == run["run"]]
        if run["satisfied"] and (moments_of_run := moments(mine)):
            strip(moments_of_run, arguments.output).save(arguments.output / "moments.png")
            break


def labelled(scenario: Any, scene: Any, folder: Path) -> Any:
    """A simulation of a scene, whose images are labelled in a folder as they come."""
    folder.mkdir(exist_ok=True)
    images = LabelledImages(folder, CAMERA, None)

    def look(simulation: Any, _poses: Any, _actions: Any) -> None:
        present = Present(simulation)
        present.k = simulation.currentTime
        images.add(present)

    run = scenario.getSimulator().simulate(
        scene,
        maxSteps=MOST_STEPS,
        name=str(scene.k),
        key=f"{scene.seed}:{scene.k}".encode(),
        keep_violations=True,
        on_state=look,
    )
    images.finish()
    return run


def labels(records: Any, run: int, folder: Path) -> Iterator[dict[str, Any]]:
    """A row for each image of a run."""
    for (step, visible), (_, distance) in zip(records["visible"], records["distance"], strict=True):
        name = f"{CAMERA}-{step:06d}"
        (car,) = (
            item
            for item in json.loads((folder / f"{name}.json").read_text())["objects"]
            if item["class"] == "Car"
        )
        yield {
            "run": run,
            "step": step,
            "seconds": step / 2,
            "image": f"{folder.name}/{name}-rgb.png",
            "visible": visible,
            "distance": round(distance, 3),
            # What a test of boxes sees: the car would be in the image if nothing stood before it.
            "in view": car["full_box"] is not None and distance <= 100,
            "occluded": car["occluded"],
        }


def moments(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The images before and after the car comes into view, and before and after it leaves it; none if it does not leave."""
    seen = [place for place, row in enumerate(rows) if row["visible"]]
    if not seen or seen[0] == 0 or seen[-1] + 1 == len(rows):
        return []
    return [rows[place] for place in (seen[0] - 1, seen[0], seen[-1], seen[-1] + 1)]


def strip(rows: list[dict[str, Any]], folder: Path) -> PIL.Image.Image:
    """Images side by side, with their time and label."""
    images = [PIL.Image.open(folder / row["image"]) for row in rows]
    width, height = images[0].size
    sheet = PIL.Image.new("RGB", (width * len(images), height))
    draw = PIL.ImageDraw.Draw(sheet)
    for place, (row, image) in enumerate(zip(rows, images, strict=True)):
        sheet.paste(image, (place * width, 0))
        words = f"{row['seconds']:g} s: {'visible' if row['visible'] else 'not visible'}"
        draw.rectangle((place * width, 0, place * width + 130, 16), fill=(20, 24, 30))
        draw.text((place * width + 6, 2), words, fill=(255, 255, 255))
    return sheet


def write(path: Path, rows: list[dict[str, Any]]) -> None:
    """A table."""
    with path.open("w", newline="") as stream:
        table = csv.DictWriter(stream, list(rows[0]))
        table.writeheader()
        table.writerows(rows)


if __name__ == "__main__":
    main()
