"""Samples labelled images and computes everything in their labels again, with other libraries.

    python -m benchmarks.labels [PROGRAM CAMERA] [--count N]

The index is read with pycocotools, the meshes are cast at with trimesh, places are projected with the matrices in the
labels. Prints what it compared and exits with 1 if anything disagrees beyond what single precision may change.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

HERE = Path(__file__).parent
EDGE = 0.02
"""Part of an object's pixels that may differ: those through which its outline passes within rounding."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", nargs="?", default=str(HERE / "street.scenic"))
    parser.add_argument("camera", nargs="?", default="front")
    parser.add_argument("--count", type=int, default=200)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        command = [sys.executable, "-m", "scenic.cli.main", "sample", arguments.program]
        options = ["-n", str(arguments.count), "--seed", "1", "--camera", arguments.camera, "-o", folder]
        subprocess.run([*command, *options], check=True)
        print(f"{arguments.count} images in {time.perf_counter() - started:.1f} s")
        return check(Path(folder), arguments.program)


def check(folder: Path, program: str) -> int:
    """Compare every label in a folder; returns the exit code."""
    from pycocotools import mask as masks
    from pycocotools.coco import COCO

    import scenic

    index = COCO(str(folder / "annotations.json"))
    names = {item["id"]: item["name"] for item in index.dataset["categories"]}
    scenario = scenic.scenarioFromFile(program)
    scenes = scenario.sample(len(index.dataset["images"]), seed=1)
    wrong: list[str] = []
    compared = shown = 0
    for image in index.dataset["images"]:
        stem = image["file_name"].rsplit("-", 1)[0]
        labels = json.loads((folder / f"{stem}.json").read_text())
        camera = labels["camera"]
        objects = {item["index"]: item for item in labels["objects"]}
        scene = scenes[image["k"]]
        meshes = {number: world_mesh(scene.objects[number]) for number in objects}
        owners, depth, alone = cast(meshes, camera)
        annotations = {item["object"]: item for item in index.imgToAnns[image["id"]]}
        for number, item in objects.items():
            compared += 1
            where = f"image {image['k']}, object {number} ({item['class']})"
            expected = owners == number
            allowed = max(3, EDGE * expected.sum(), EDGE * alone[number].sum())
            problems = compare_geometry(item, camera, meshes[number])
            if abs(int(alone[number].sum()) - item["full_pixels"]) > allowed:
                problems.append(f"{item['full_pixels']} pixels alone, not {alone[number].sum()}")
            if number not in annotations:
                if expected.sum() > 3:
                    problems.append(f"no annotation, but {expected.sum()} pixels")
            else:
                shown += 1
                annotation = annotations[number]
                mask = index.annToMask(annotation).astype(bool)
                encoded = masks.frPyObjects(annotation["segmentation"], *mask.shape)
                if (mask != expected).sum() > allowed:
                    problems.append(f"{(mask != expected).sum()} pixels of the mask differ")
                if not mask.sum() == annotation["area"] == item["pixels"] == masks.area(encoded):
                    problems.append("areas differ")
                if masks.toBbox(encoded).tolist() != annotation["bbox"] or annotation["bbox"] != item["box"]:
                    problems.append("boxes differ")
                if names[annotation["category_id"]] != item["class"]:
                    problems.append("classes differ")
                share = 1 - item["pixels"] / item["full_pixels"]
                if abs(share - item["occluded"]) > 1e-12:
                    problems.append("occluded shares differ")
                near = depth[expected & mask]
                if len(near) and abs(near.min() - item["nearest"]) > 1e-3 * near.min():
                    problems.append(f"nearest {item['nearest']}, not {near.min()}")
                # Where two by two pixels show it, a ray of `can see` passes between their middles.
                block = mask[1:, 1:] & mask[1:, :-1] & mask[:-1, 1:] & mask[:-1, :-1]
                if block.any() and not item["visible"]:
                    problems.append(f"not visible, but {item['pixels']} pixels")
            wrong += [f"{where}: {problem}" for problem in problems]
    print(f"{compared} objects compared, {shown} of them in the images: {len(wrong)} disagreements")
    for line in wrong[:20]:
        print(" ", line)
    return 1 if wrong else 0


def world_mesh(thing: Any) -> trimesh.Trimesh:
    """The mesh of an object of a scene, in the world."""
    unit = thing.shape.mesh
    turn = thing.orientation
    size = [thing.width, thing.length, thing.height]
    mesh = trimesh.Trimesh(unit.vertices * size, unit.faces, process=False)
    matrix = trimesh.transformations.quaternion_matrix([turn.w, turn.x, turn.y, turn.z])
    matrix[:3, 3] = list(thing.position)
    return mesh.apply_transform(matrix)


def cast(
    meshes: dict[int, trimesh.Trimesh], camera: dict
) -> tuple[np.ndarray, np.ndarray, dict[int, np.ndarray]]:
    """Per pixel the nearest object (-1 for none) and its depth; and for each object, the pixels it has alone."""
    width, height = camera["size"]
    column, row = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    pixels = np.stack([column, row, np.ones_like(row)], axis=-1).reshape(-1, 3)
    local = pixels @ np.linalg.inv(np.array(camera["intrinsics"])).T
    extrinsics = np.array(camera["extrinsics"])
    directions = local @ extrinsics[:3, :3]
    origins = np.broadcast_to(camera["position"], directions.shape)
    nearest = np.full(len(pixels), np.inf)
    owners = np.full(len(pixels), -1)
    alone = {}
    for number, mesh in meshes.items():
        places, ray, _ = mesh.ray.intersects_location(origins, directions, multiple_hits=False)
        depth = np.full(len(pixels), np.inf)
        depth[ray] = (places - origins[ray]) @ extrinsics[2, :3]
        alone[number] = np.isfinite(depth).reshape(height, width)
        owners[depth < nearest] = number
        nearest = np.minimum(nearest, depth)
    return owners.reshape(height, width), nearest.reshape(height, width), alone


def compare_geometry(item: dict, camera: dict, mesh: trimesh.Trimesh) -> list[str]:
    """Return the errors of the box in space and its projection."""
    problems = []
    extrinsics, intrinsics = np.array(camera["extrinsics"]), np.array(camera["intrinsics"])
    matrix = trimesh.transformations.quaternion_matrix(np.roll(item["quaternion"], 1))[:3, :3]
    signs = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    corners = item["position"] + (signs * item["size"]) @ matrix.T
    local = corners @ extrinsics[:3, :3].T + extrinsics[:3, 3]
    for (column, row, depth), point in zip(item["corners"], local, strict=True):
        if abs(depth - point[2]) > 1e-9 * (1 + abs(depth)):
            problems.append("depth of a corner")
        elif depth > 0:
            expected = intrinsics @ point / point[2]
            if abs(column - expected[0]) > 1e-6 * (1 + abs(column)) or abs(row - expected[1]) > 1e-6 * (
                1 + abs(row)
            ):
                problems.append("place of a corner")
    inside = (mesh.vertices - item["position"]) @ matrix / item["size"]
    if np.abs(inside).max() > 0.5 + 1e-6 or np.abs(inside).max(axis=0).min() < 0.5 - 1e-6:
        problems.append("the box is not that of the mesh")
    middle = extrinsics[:3, :3] @ item["position"] + extrinsics[:3, 3]
    if abs(middle[2] - item["depth"]) > 1e-9 * (1 + abs(middle[2])):
        problems.append("depth of the middle")
    return problems


if __name__ == "__main__":
    raise SystemExit(main())
