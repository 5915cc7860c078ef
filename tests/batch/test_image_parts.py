"""Labelled images as data sets: the same bytes whatever makes them, and readable by others' libraries."""

import gc
import io
import json
import shutil
import tarfile
import warnings
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest

import scenic
from scenic.batch.datasets import DatasetRun, make_dataset
from scenic.batch.engines import OverExecutor, Processes
from scenic.batch.manifest import NAME, DatasetError, Manifest
from scenic.batch.verifying import merge, verify
from scenic.formats.coco import run_lengths
from scenic.formats.scene_cameras import CameraError

PROGRAM = """
from scenic import RGBSensor, SSSensor
class Crate:
    width: Range(0.5, 1)
class Cone:
    shape: ConeShape()
    width: Range(0.3, 0.6)
ego = new Crate with sensors {"front": RGBSensor(width=40, height=30), "kinds": SSSensor(width=40, height=30)}
cone = new Cone at (Range(-2, 2), Range(3, 9))
new Crate at (Range(-2, 2), Range(3, 9))
require cone.position.x > -1
"""


@pytest.fixture(scope="module")
def scenario() -> scenic.Scenario:
    return scenic.scenarioFromString(PROGRAM, filename="given.scenic")


def manifest(scenario: scenic.Scenario, form: str, camera: str = "front", **settings: Any) -> Manifest:
    images = {"cameras": camera.split(), "size": None, "overlay": form == "images"}
    chosen = {"seed": 3, "count": 7, "part_size": 3, **settings}
    return Manifest.of(scenario, form=form, images=images, **chosen)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != NAME}


@pytest.fixture(scope="module", params=["images", "tar"])
def made(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, scenario: scenic.Scenario
) -> Path:
    folder = tmp_path_factory.mktemp(request.param)
    make_dataset(scenario, folder, manifest(scenario, request.param))
    return folder


def form_of(folder: Path) -> str:
    return Manifest.load(folder).form


def test_images_do_not_depend_on_what_makes_them(
    made: Path, scenario: scenic.Scenario, tmp_path: Path
) -> None:
    wanted = manifest(scenario, form_of(made))
    make_dataset(scenario, tmp_path / "processes", wanted, DatasetRun(Processes(2)))
    assert contents(tmp_path / "processes") == contents(made)
    with ThreadPoolExecutor(2) as executor:
        make_dataset(scenario, tmp_path / "threads", wanted, DatasetRun(OverExecutor(executor, 2)))
    assert contents(tmp_path / "threads") == contents(made)


def test_an_interrupted_run_goes_on_to_the_same_bytes(
    made: Path, scenario: scenic.Scenario, tmp_path: Path
) -> None:
    wanted, left = manifest(scenario, form_of(made)), 4

    def end(_scenes: int, _attempts: int) -> None:
        nonlocal left
        left -= 1
        if left < 0:
            raise KeyboardInterrupt

    with ThreadPoolExecutor(1) as executor, pytest.raises(KeyboardInterrupt):
        # Pieces of one scene each.
        make_dataset(scenario, tmp_path, wanted, DatasetRun(OverExecutor(executor, 4), advance=end))
    assert not Manifest.load(tmp_path).is_complete
    with pytest.raises(DatasetError, match="holds a data set"):
        make_dataset(scenario, tmp_path, wanted)
    make_dataset(scenario, tmp_path, wanted, resume=True)
    assert contents(tmp_path) == contents(made)


def test_a_second_shard_is_a_folder_of_its_own_and_joined(
    made: Path, scenario: scenic.Scenario, tmp_path: Path
) -> None:
    form = form_of(made)
    make_dataset(scenario, tmp_path / "a", manifest(scenario, form, count=3))
    make_dataset(scenario, tmp_path / "b", manifest(scenario, form, first=3, count=4))
    merge([tmp_path / "b", tmp_path / "a"], tmp_path / "ab")
    assert contents(tmp_path / "ab") == contents(made)


def test_planted_damages_are_named(made: Path, scenario: scenic.Scenario, tmp_path: Path) -> None:
    whole = tmp_path / "whole"
    shutil.copytree(made, whole)
    assert list(verify(whole, scenario, share=1)) == []
    planted = (
        ["front-000002-rgb.png", "front-000005.json"]
        if form_of(made) == "images"
        else [sorted(made.glob("part-*.tar"))[1].name, sorted(made.glob("part-*.json"))[2].name]
    )
    for name in planted:
        damaged = tmp_path / name
        shutil.copytree(made, damaged)
        content = bytearray((damaged / name).read_bytes())
        content[-9] ^= 1
        (damaged / name).write_bytes(content)
        (found,) = verify(damaged, scenario, share=0)
        assert "changed since it was written" in found.what
        assert Path(found.file).stem.partition("-rgb")[0] == Path(name).stem.partition("-rgb")[0]
        (damaged / name).unlink()
        (found,) = verify(damaged, scenario, share=0)
        assert (found.file, found.what) == (name, "the file is missing")
        with pytest.raises(DatasetError):
            merge([damaged], tmp_path / f"merged-{name}")


def test_a_camera_that_is_not_there_leaves_the_folder_free(scenario: scenic.Scenario, tmp_path: Path) -> None:
    with pytest.raises(CameraError, match="no camera 'back'"):
        make_dataset(scenario, tmp_path, manifest(scenario, "images", "back", count=1))
    make_dataset(scenario, tmp_path, manifest(scenario, "images", count=1))


def test_other_scenes_than_the_programs_are_noticed(made: Path, scenario: scenic.Scenario) -> None:
    other = Manifest.load(made)
    twin = scenic.scenarioFromString(
        PROGRAM.replace("Range(0.3, 0.6)", "Range(0.2, 0.6)"), filename="given.scenic"
    )
    with pytest.raises(DatasetError, match="of another program"):
        list(verify(made, twin))
    assert other.images == {"cameras": ["front"], "size": None, "overlay": other.form == "images"}


@pytest.mark.parametrize("form", ["images", "tar"])
def test_several_cameras_are_one_data_set(form: str, scenario: scenic.Scenario, tmp_path: Path) -> None:
    make_dataset(scenario, tmp_path / "both", manifest(scenario, form, "front kinds"))
    shots: dict[int, dict[str, Any]] = {}
    for index in indices(tmp_path / "both"):
        shots |= {image["id"]: image for image in index["images"]}
        assert all(item["image_id"] in shots for item in index["annotations"])
    assert [(shot["k"], shot["camera"]) for shot in shots.values()] == [
        (k, camera) for k in range(7) for camera in ("front", "kinds")
    ]
    assert not list(verify(tmp_path / "both", scenario, share=1))
    # Each camera has the images that it has alone.
    for camera in ("front", "kinds"):
        make_dataset(scenario, tmp_path / camera, manifest(scenario, form, camera))
        alone = [image for index in indices(tmp_path / camera) for image in index["images"]]
        mine = [shot for shot in shots.values() if shot["camera"] == camera]
        assert [shot["sha256"] for shot in mine] == [image["sha256"] for image in alone]


def test_an_object_may_name_its_category(tmp_path: Path) -> None:
    scenario = scenic.scenarioFromString(
        """
from scenic import SSSensor
kind = Uniform(("mug", CylinderShape()), ("bowl", ConeShape()))
ego = new Object with sensors {"front": SSSensor(width=40, height=30)}
new Object at (0, 5), with shape kind[1], with category kind[0]
new Object at (0, 8), with category "wall", with width 9, with height 9
"""
    )
    make_dataset(scenario, tmp_path, manifest(scenario, "images", count=12))
    joined = json.loads((tmp_path / "annotations.json").read_bytes())
    assert [item["name"] for item in joined["categories"]] == ["Object", "mug", "bowl", "wall"]
    # The numbers of a scene's objects in order: a mug or a bowl, then the wall.
    assert {item["category_id"] for item in joined["annotations"] if item["object"] == 1} == {2, 3}
    assert {item["category_id"] for item in joined["annotations"] if item["object"] == 2} == {4}


def indices(folder: Path) -> Iterator[dict[str, Any]]:
    yield from (json.loads(path.read_bytes()) for path in sorted(folder.glob("part-*.json")))


def test_the_indices_agree_with_the_images(scenario: scenic.Scenario, tmp_path: Path) -> None:
    make_dataset(scenario, tmp_path, manifest(scenario, "images", "kinds"))
    joined = json.loads((tmp_path / "annotations.json").read_bytes())
    parts = list(indices(tmp_path))
    assert [image for part in parts for image in part["images"]] == joined["images"]
    assert [item for part in parts for item in part["annotations"]] == joined["annotations"]
    assert joined["categories"] == [{"id": 1, "name": "Crate"}, {"id": 2, "name": "Cone"}]
    assert len({item["id"] for item in joined["annotations"]}) == len(joined["annotations"]) > 7
    masks = {
        image["id"]: np.array(PIL.Image.open(tmp_path / image["file_name"])) for image in joined["images"]
    }
    for item in joined["annotations"]:
        mask = masks[item["image_id"]] == item["category_id"]
        assert run_lengths(mask) == item["segmentation"]["counts"]


def test_shards_are_read_as_others_read_them(scenario: scenic.Scenario, tmp_path: Path) -> None:
    make_dataset(scenario, tmp_path, manifest(scenario, "tar"))
    shards = sorted(tmp_path.glob("part-*.tar"))
    kept = []
    for shard in shards:
        with tarfile.open(shard) as archive:
            for name in archive.getnames():
                if name.endswith(".rgb.png"):
                    pixels = PIL.Image.open(io.BytesIO(archive.extractfile(name).read()))  # type: ignore[union-attr]
                    labels = json.loads(archive.extractfile(name.replace(".rgb.png", ".json")).read())  # type: ignore[union-attr]
                    kept.append((labels["k"], np.asarray(pixels)))
    assert [k for k, _ in kept] == list(range(7))
    assert all(pixels.shape == (30, 40, 3) for _, pixels in kept)
    index = [image["file_name"] for part in indices(tmp_path) for image in part["images"]]
    assert index == [f"front-{k:06d}.rgb.png" for k in range(7)]


def test_the_datasets_library_reads_shards(scenario: scenic.Scenario, tmp_path: Path) -> None:
    datasets = pytest.importorskip("datasets")
    make_dataset(scenario, tmp_path / "made", manifest(scenario, "tar"))
    rows = datasets.load_dataset(
        "webdataset",
        data_files=str(tmp_path / "made" / "part-*.tar"),
        split="train",
        cache_dir=str(tmp_path / "cache"),
    )
    assert [row["json"]["k"] for row in rows] == list(range(7))
    assert all(row["rgb.png"].size == (40, 30) for row in rows)


def test_webdataset_reads_shards(scenario: scenic.Scenario, tmp_path: Path) -> None:
    webdataset = pytest.importorskip("webdataset")
    make_dataset(scenario, tmp_path, manifest(scenario, "tar"))
    with warnings.catch_warnings():
        # It leaves files to be closed by the collector of garbage.
        warnings.simplefilter("ignore", ResourceWarning)
        samples = webdataset.WebDataset(
            str(tmp_path / "part-{00000..00002}.tar"), shardshuffle=False
        ).decode()
        found = [sample["json"]["k"] for sample in samples]
        gc.collect()
    assert found == list(range(7))
