"""Data sets: the same bytes whatever made them, whatever interrupted them."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import scenic
from scenic.batch import scene_bytes
from scenic.batch.datasets import DatasetRun, make_dataset, write_table
from scenic.batch.engines import OverExecutor, Processes
from scenic.batch.manifest import NAME, DatasetError, Manifest
from scenic.batch.verifying import merge, part_rows, verify
from scenic.formats.json_lines import scene_document

pytest.importorskip("pyarrow")

PROGRAM = """
param noise = Normal(0, 1), word = Uniform("a", "b"), pair = (Range(0, 1), 2)
ego = new Object at (Range(0, 1), Range(0, 1), 0), facing Range(0, 360) deg, with foo Uniform(1, 2.5), with label "x"
other = new Object at (Range(5, 9), 0, 0), with target ego, with width Range(1, 2), with place Range(0, 1) @ 2
def small(v): return v < 0.7
require small(ego.position.x)
"""


@pytest.fixture(scope="module")
def scenario() -> scenic.Scenario:
    return scenic.scenarioFromString(PROGRAM, filename="given.scenic")


def manifest(scenario: scenic.Scenario, **settings: object) -> Manifest:
    chosen = {"seed": 3, "count": 50, "part_size": 20, **settings}
    return Manifest.of(scenario, **chosen)  # type: ignore[arg-type]


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != NAME}


@pytest.mark.parametrize("form", ["parquet", "jsonl"])
def test_parts_do_not_depend_on_what_makes_them(scenario: scenic.Scenario, tmp_path: Path, form: str) -> None:
    wanted = manifest(scenario, form=form)
    alone = make_dataset(scenario, tmp_path / "alone", wanted)
    assert alone.manifest.is_complete
    assert [part.file for part in alone.manifest.parts] == [
        f"part-{numbers}.{form}"
        for numbers in ("00000000-00000019", "00000020-00000039", "00000040-00000049")
    ]
    expected = contents(tmp_path / "alone")
    make_dataset(scenario, tmp_path / "shared", wanted, DatasetRun(Processes(2)))
    assert contents(tmp_path / "shared") == expected
    with ThreadPoolExecutor(2) as executor:
        make_dataset(scenario, tmp_path / "threads", wanted, DatasetRun(OverExecutor(executor, 2)))
    assert contents(tmp_path / "threads") == expected


def test_rows_say_what_scenes_say(scenario: scenic.Scenario, tmp_path: Path) -> None:
    write_table(scenario, tmp_path / "scenes.parquet", manifest(scenario))
    rows = list(part_rows(tmp_path / "scenes.parquet", "parquet"))
    for row, scene in zip(rows, scenario.sample(50, seed=3), strict=True):
        document = scene_document(scene)
        assert (row["k"], row["attempts"]) == (scene.k, scene.attempts)
        assert row["params"]["noise"] == scene.params["noise"]
        assert row["params"]["word"] == scene.params["word"]
        assert json.loads(row["params"]["pair"]) == document["params"]["pair"]
        for thing, told in zip(row["objects"], document["objects"], strict=True):
            assert thing["class"] == told["class"]
            assert thing["name"] == told["name"]
            for key in ("position", "quaternion", "size"):
                assert thing[key] == told[key]
            assert json.loads(thing["shape"]) == told["shape"]
        ego, other = (thing["properties"] for thing in row["objects"])
        assert ego["foo"] == scene.objects[0].foo
        assert ego["label"] == "x"
        assert ego["target"] is None
        assert json.loads(other["target"]) == {"$object": 0}
        assert other["place"] == list(scene.objects[1].place)


def test_other_libraries_read_the_parts(scenario: scenic.Scenario, tmp_path: Path) -> None:
    """As ``docs/howto/datasets.md`` says."""
    make_dataset(scenario, tmp_path, manifest(scenario))
    arrow_dataset = pytest.importorskip("pyarrow.dataset")
    table = arrow_dataset.dataset(tmp_path, format="parquet", exclude_invalid_files=True).to_table()
    rows = table.to_pylist()
    assert sorted(row["k"] for row in rows) == list(range(50))
    try:
        import pandas
        import polars
        from datasets import load_dataset
    except ImportError as error:
        pytest.skip(f"{error.name} is not installed")
    part = tmp_path / "part-00000000-00000019.parquet"
    assert pandas.read_parquet(part)["k"].tolist() == list(range(20))
    frame = polars.read_parquet(tmp_path / "part-*.parquet")
    assert frame["k"].to_list() == list(range(50))
    assert frame["objects"][0][0]["position"] == rows[0]["objects"][0]["position"]
    files = str(tmp_path / "part-*.parquet")
    streamed = load_dataset("parquet", data_files=files, split="train", streaming=True)
    assert [row["k"] for row in streamed] == list(range(50))


def test_a_column_is_typed_by_all_objects_that_have_it() -> None:
    from scenic.formats.scene_tables import SceneTable

    table = SceneTable(
        scenic.scenarioFromString(
            "ego = new Object with a 1, with b 1, with c True, with d None, with e 'x', with f (1, 2)\n"
            "new Object at (9, 9, 9), with a 2.5, with b 'y', with c None, with e Uniform('p', 'q')\n"
        )
    )
    kinds = {
        field.name: str(field.type)
        for field in table.schema.field("objects").type.value_type.field("properties").type
    }
    assert kinds["a"] == "double"
    assert kinds["b"] == "string"  # JSON of either
    assert kinds["c"] == "bool"
    assert kinds["d"] == "bool"  # nothing is known of it
    assert kinds["e"] == "string"


def test_a_journal_saves_looking_again(
    scenario: scenic.Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run that ends within a part goes on behind its last scene, to the bytes of an undisturbed run."""
    wanted = manifest(scenario, form="jsonl", part_size=50)
    make_dataset(scenario, tmp_path / "whole", wanted)

    class Ended(Exception):
        pass

    seen = 0

    def advance(count: int, _attempts: int) -> None:
        nonlocal seen
        seen += count
        if seen > 10:
            raise Ended

    monkeypatch.setattr(scene_bytes, "LONGEST", 4)
    with pytest.raises(Ended):
        make_dataset(scenario, tmp_path / "ended", wanted, DatasetRun(advance=advance))
    names = sorted(path.name for path in (tmp_path / "ended").iterdir())
    assert names == [NAME, "part-00000000.journal"]
    journal = np.fromfile(tmp_path / "ended" / "part-00000000.journal", dtype=np.int64).reshape(-1, 2)
    assert journal[:, 0].tolist() == list(range(len(journal)))
    assert 8 <= len(journal) < 50
    with (tmp_path / "ended" / "part-00000000.journal").open("ab") as stream:
        stream.write(b"torn")  # the process was killed while it wrote
    told: list[int] = []
    make_dataset(
        scenario,
        tmp_path / "ended",
        wanted,
        DatasetRun(advance=lambda count, _: told.append(count)),
        resume=True,
    )
    assert told[: len(journal)] == [1] * len(journal)
    assert contents(tmp_path / "ended") == contents(tmp_path / "whole")


def test_scenes_that_are_not_found_are_left_out(tmp_path: Path) -> None:
    scenario = scenic.scenarioFromString(
        "def half(v): return v < 0.5\nego = new Object with foo Range(0, 1)\nrequire half(ego.foo)\n"
    )
    wanted = manifest(scenario, max_attempts=1, form="jsonl")
    finished = make_dataset(scenario, tmp_path / "one", wanted)
    lost = [k for part in finished.manifest.parts for k in part.missing]
    assert 10 < len(lost) < 40
    assert [item.k for item in finished.missing] == lost
    assert finished.manifest.rows == 50 - len(lost)
    assert sum(part.attempts for part in finished.manifest.parts) == 50
    assert not list(verify(tmp_path / "one", scenario, share=1))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"seed": 4}, "seed 4, not 3"),
        ({"part_size": 10}, "part_size"),
        ({"versions": {"python": "2"}}, "versions"),
    ],
)
def test_another_data_set_is_not_continued(
    scenario: scenic.Scenario, tmp_path: Path, change: dict[str, object], message: str
) -> None:
    wanted = manifest(scenario, form="jsonl")
    make_dataset(scenario, tmp_path, wanted)
    with pytest.raises(DatasetError, match="holds a data set of 50 scenes already"):
        make_dataset(scenario, tmp_path, wanted)
    with pytest.raises(DatasetError, match=message):
        make_dataset(scenario, tmp_path, replace(wanted, **change), resume=True)  # type: ignore[arg-type]


def test_more_scenes_are_added(scenario: scenic.Scenario, tmp_path: Path) -> None:
    make_dataset(scenario, tmp_path / "some", manifest(scenario, form="jsonl"))
    longer = manifest(scenario, form="jsonl", count=75)
    make_dataset(scenario, tmp_path / "some", longer, resume=True)
    make_dataset(scenario, tmp_path / "all", longer)
    assert contents(tmp_path / "some") == contents(tmp_path / "all")


@pytest.mark.parametrize("form", ["parquet", "jsonl"])
def test_every_damage_is_named(scenario: scenic.Scenario, tmp_path: Path, form: str) -> None:
    make_dataset(scenario, tmp_path, manifest(scenario, form=form))
    assert not list(verify(tmp_path, scenario, share=0.2))
    rng = random.Random(form)
    for _ in range(20):
        path = rng.choice([item for item in tmp_path.iterdir() if item.name != NAME])
        content = path.read_bytes()
        place = rng.randrange(len(content))
        path.write_bytes(
            content[:place] + bytes([content[place] ^ 1 << rng.randrange(8)]) + content[place + 1 :]
        )
        assert [item.file for item in verify(tmp_path, None)] == [path.name]
        path.write_bytes(content)
    (tmp_path / f"part-00000020-00000039.{form}").unlink()
    assert [item.what for item in verify(tmp_path, None)] == ["the file is missing"]


def test_a_scene_of_another_program_is_noticed(scenario: scenic.Scenario, tmp_path: Path) -> None:
    """A part whose digest was forged still differs from what the program gives."""
    from scenic.formats.mesh_files import digest_of

    finished = make_dataset(scenario, tmp_path, manifest(scenario, form="jsonl"))
    path = tmp_path / "part-00000000-00000019.jsonl"
    path.write_bytes(path.read_bytes().replace(b'"word":"a"', b'"word":"b"', 1))
    part = replace(finished.manifest.parts[0], sha256=digest_of(path))
    changed = replace(finished.manifest, parts=(part, *finished.manifest.parts[1:]))
    (tmp_path / NAME).write_text(json.dumps(changed.document()))
    [found] = verify(tmp_path, scenario, share=1)
    assert "differs from that of the program" in found.what
    other = scenic.scenarioFromString(PROGRAM + "x = 1\n")
    with pytest.raises(DatasetError, match="another program"):
        list(verify(tmp_path, other))


def test_data_sets_are_merged(scenario: scenic.Scenario, tmp_path: Path) -> None:
    whole = make_dataset(scenario, tmp_path / "whole", manifest(scenario, form="jsonl", count=40))
    for first in (0, 20):
        part = manifest(scenario, form="jsonl", first=first, count=20)
        make_dataset(scenario, tmp_path / str(first), part)
    merged = merge([tmp_path / "20", tmp_path / "0"], tmp_path / "merged")
    assert (merged.first, merged.count, merged.rows) == (0, 40, 40)
    assert contents(tmp_path / "merged") == contents(tmp_path / "whole")
    assert merged.parts == whole.manifest.parts
    with pytest.raises(DatasetError, match="another part holds, too"):
        merge([tmp_path / "0", tmp_path / "whole"], tmp_path / "twice")


def test_a_folder_without_a_manifest_is_no_data_set(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="no data set"):
        Manifest.load(tmp_path)
    (tmp_path / NAME).write_text('{"format": "scenic-dataset", "version": 3}')
    with pytest.raises(DatasetError, match="it has no `program`"):
        Manifest.load(tmp_path)


SLOW = """
import time
def wait(v):
    time.sleep(0.01)
    return v < 0.7
ego = new Object with foo Range(0, 1)
require wait(ego.foo)
"""


@pytest.mark.slow
def test_a_killed_run_goes_on_to_the_same_bytes(tmp_path: Path) -> None:
    program = tmp_path / "slow.scenic"
    program.write_text(SLOW)
    command = [sys.executable, "-m", "scenic", "sample", str(program), "-n", "120", "--seed", "5"]
    command += ["--format", "jsonl", "--part-size", "50", "-j", "2"]
    subprocess.run([*command, "-o", f"{tmp_path}/whole/"], check=True, capture_output=True)
    rng = random.Random(4)
    for _ in range(2):
        process = subprocess.Popen(
            [*command, "-o", f"{tmp_path}/killed/", "--resume"],
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        time.sleep(rng.uniform(0.6, 1.4))
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    done = subprocess.run(
        [*command, "-o", f"{tmp_path}/killed/", "--resume"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert contents(tmp_path / "killed") == contents(tmp_path / "whole")
