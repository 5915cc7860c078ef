"""Folders and files that commands write: nothing is lost, mixed or written elsewhere with exit code 0."""

import json
import os
import shutil
import warnings
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from scenic.batch.folders.lock import LOCK, Lock, lock_beside
from scenic.formats.files import safe_name
from scenic.language.errors import ScenicWarning
from tests.cli.commands import run_here

PROGRAM = "from pylib import LOW\nego = new Object at (Range(LOW, 5), 0)\n"
MOVING = "from pylib import LOW\nbehavior B():\n    wait\n    wait\nego = new Object at (Range(LOW, 5), 0), with behavior B\n"

Run = Callable[..., "CompletedProcess[str]"]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    (tmp_path / "p.scenic").write_text(PROGRAM)
    (tmp_path / "moving.scenic").write_text(MOVING)
    (tmp_path / "pylib.py").write_text("LOW = 0\n")

    def command(line: str, code: int = 0) -> "CompletedProcess[str]":
        with warnings.catch_warnings():
            warnings.simplefilter("always", ScenicWarning)
            done = run_here(line.split(), folder=tmp_path)
        assert done.returncode == code, done.stderr
        assert "internal error" not in done.stderr
        return done

    return command


def change_library(folder: Path, low: int) -> None:
    """Change a constant as an editor does between two commands, each of which would be a process of its own."""
    import sys

    (folder / "pylib.py").write_text(f"LOW = {low}\n# {low}\n")
    shutil.rmtree(folder / "__pycache__", ignore_errors=True)
    sys.modules.pop("pylib", None)


@pytest.fixture(autouse=True)
def forget_library() -> None:
    import sys

    sys.modules.pop("pylib", None)


def numbers(folder: Path) -> list[int]:
    """The scenes in all JSON Lines of a folder, as somebody reads them who takes all files of that name."""
    return [
        json.loads(line)["k"]
        for path in sorted(folder.glob("*.jsonl"))
        for line in path.read_text().splitlines()
    ]


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


JSONL = "--seed 7 --format jsonl --part-size 10"


def test_a_gap_between_merged_data_sets_is_told_and_filled(run: Run, tmp_path: Path) -> None:
    run(f"sample p.scenic {JSONL} -n 10 -o a/")
    run(f"sample p.scenic {JSONL} -n 10 --first 20 -o c/")
    run(f"sample p.scenic {JSONL} -n 30 -o whole/")
    assert "lacks the scenes 10 to 19" in run("dataset merge c a -o m/").stderr
    run("sample p.scenic -n 30 -o m/ --resume")
    assert numbers(tmp_path / "m") == list(range(30))
    run("dataset verify m --share 100%")
    parts = [
        {name: data for name, data in contents(tmp_path / folder).items() if name != "manifest.json"}
        for folder in ("m", "whole")
    ]
    assert parts[0] == parts[1]


def test_merging_leaves_what_is_there(run: Run, tmp_path: Path) -> None:
    run(f"sample p.scenic {JSONL} -n 10 -o a/")
    run(f"sample p.scenic {JSONL} -n 10 --first 10 -o b/")
    run("sample p.scenic --seed 8 --format jsonl -n 20 -o y/")
    before = {name: contents(tmp_path / name) for name in "aby"}
    for target in ("y", "a", "a/"):
        assert "error[SC612]" in run(f"dataset merge a b -o {target}", 1).stderr
    (tmp_path / "b" / "part-00000010-00000019.jsonl").write_text("")
    assert "has changed" in run("dataset merge a b -o joined", 1).stderr
    assert not (tmp_path / "joined").exists()
    assert not list(tmp_path.glob(".*"))
    assert {name: contents(tmp_path / name) for name in "ay"} == {name: before[name] for name in "ay"}


@pytest.mark.parametrize(
    ("line", "target"),
    [
        (f"sample p.scenic {JSONL} -n 5 -o busy/", "busy"),
        ("sample p.scenic --seed 1 -n 5 -o busy.jsonl", "busy.jsonl"),
        ("sample p.scenic --seed 1 -n 5 -o busy.parquet", "busy.parquet"),
        ("sample p.scenic -o busy.glb", "busy.glb"),
        ("sample p.scenic -n 2 -o busy.obj", "busy.obj"),
        ("sample p.scenic --view busy.html", "busy.html"),
        ("sample p.scenic --png busy.png", "busy.png"),
        ("sample p.scenic --png busy", "busy"),
        ("simulate moving.scenic --table busy.csv", "busy.csv"),
        ("simulate moving.scenic --plot busy.svg", "busy.svg"),
        ("simulate moving.scenic --view busy.html", "busy.html"),
        (
            "falsify p.scenic --static --minimize 1 --threshold 2 --sampler random -n 2 --report busy.html",
            "busy.html",
        ),
        ("simulate moving.scenic --seed 1 -o busy", "busy"),
        (
            "falsify p.scenic --static --minimize 1 --threshold 2 --sampler random -n 2 --seed 1 -o busy",
            "busy",
        ),
    ],
)
def test_a_second_writer_is_refused(run: Run, tmp_path: Path, line: str, target: str) -> None:
    path = tmp_path / target
    if "." in target:
        lock = lock_beside(path)
    else:
        path.mkdir()
        lock = Lock(path / LOCK, path)
    with lock:
        before = written(tmp_path)
        refused = run(line, 1)
        holder = f"error[SC615]: another command is writing '{target}': process {os.getpid()} on "
        assert holder in refused.stderr
        assert written(tmp_path) == before
    run(line)


def written(place: Path) -> list[Path]:
    """All files of a folder but compiled programs, which any command may leave beside them."""
    return sorted(path for path in place.rglob("*") if "__pycache__" not in path.parts)


CONTINUED = {
    "data set": (f"sample p.scenic {JSONL} -n 5 -o out/", f"sample p.scenic {JSONL} -n 15 -o out/ --resume"),
    "lines": ("sample p.scenic --seed 7 -n 5 -o out.jsonl", "sample p.scenic -n 15 -o out.jsonl --resume"),
    "simulations": ("simulate moving.scenic --seed 7 -o out", "simulate moving.scenic -n 2 -o out --resume"),
    "search": (
        "falsify p.scenic --static --minimize 1 --threshold 2 --sampler random -n 2 --batch 2 --seed 1 -o out",
        "falsify p.scenic --static --minimize 1 --threshold 2 --sampler random -n 4 --batch 2 -o out --resume",
    ),
}


@pytest.mark.parametrize("kind", CONTINUED)
def test_changed_modules_are_named_or_accepted(run: Run, tmp_path: Path, kind: str) -> None:
    first, second = CONTINUED[kind]
    run(first)
    change_library(tmp_path, 4)
    refused = run(second, 1).stderr
    assert "'pylib.py' has changed" in refused or "other modules" in refused
    run(f"{second} --accept-changes")
    if kind != "lines":
        accepted = json.loads((tmp_path / "out" / "manifest.json").read_text())["accepted"]
        assert [item["changes"] for item in accepted] == [["'pylib.py' has changed"]]
    run(second)  # the change is accepted once


def test_a_run_is_replayed_with_its_own_modules(run: Run, tmp_path: Path) -> None:
    run("simulate moving.scenic --seed 7 -o out")
    assert "the same as kept" in run("replay out").stdout
    change_library(tmp_path, 4)
    assert "error[SC609]" in (refused := run("replay out", 1).stderr)
    assert "'pylib.py' has changed" in refused
    assert "differs: 'pylib.py' has changed" in run("replay out --accept-changes", 3).stdout


def test_scenes_that_an_earlier_run_did_not_find_are_reported(run: Run, tmp_path: Path) -> None:
    """A run that goes on ends as one that nothing has interrupted: with code 3 where scenes are missing."""
    (tmp_path / "rare.scenic").write_text(
        "def f(x): return x > 0.5\nego = new Object with foo Range(0, 1)\nrequire f(ego.foo)\n"
    )
    for target in ("s.jsonl", "set/ --format jsonl --part-size 5"):
        sample = f"sample rare.scenic --seed 1 --max-attempts 1 -o {target}"
        run(f"{sample} -n 9", 3)  # scene 8 is there, and four before it are not
        assert (
            "did not find, and that are not looked for again: 4" in run(f"{sample} -n 9 --resume", 3).stderr
        )


def test_fewer_scenes_are_refused_with_both_remedies(run: Run, tmp_path: Path) -> None:
    run(f"sample p.scenic {JSONL} -n 40 -o a/")
    refused = run(f"sample p.scenic {JSONL} -n 20 -o a/ --resume", 1).stderr
    assert "go on with -n 40 or more; or make the first 20 in another folder" in refused
    assert numbers(tmp_path / "a") == list(range(40))


def test_files_that_do_not_belong_are_reported(run: Run, tmp_path: Path) -> None:
    run(f"sample p.scenic {JSONL} -n 20 -o a/")
    shutil.copy(
        tmp_path / "a" / "part-00000000-00000009.jsonl", tmp_path / "a" / "part-00000020-00000029.jsonl"
    )
    report = run("dataset verify a", 1).stdout
    assert "part-00000020-00000029.jsonl: the file does not belong to the data set" in report


def test_simulations_of_another_seed_or_program_are_refused(run: Run, tmp_path: Path) -> None:
    run("simulate moving.scenic --seed 7 -n 2 -o sims")
    before = contents(tmp_path / "sims")
    assert "holds simulations already" in run("simulate moving.scenic --seed 7 -n 2 -o sims", 1).stderr
    assert "seed 8, not 7" in run("simulate moving.scenic --seed 8 -n 2 -o sims --resume", 1).stderr
    assert "program" in run("simulate p.scenic -n 2 -o sims --resume", 1).stderr
    assert contents(tmp_path / "sims") == before
    run("simulate moving.scenic -n 3 -o sims --resume")
    again = contents(tmp_path / "sims")
    assert set(again) - set(before) == {"simulation-0002.jsonl"}
    assert {name: again[name] for name in before} == before


@pytest.mark.parametrize("flip", [False, True])
def test_a_damaged_part_is_made_again(run: Run, tmp_path: Path, flip: bool) -> None:
    run(f"sample p.scenic {JSONL} -n 20 -o a/")
    part = tmp_path / "a" / "part-00000010-00000019.jsonl"
    whole = part.read_bytes()
    part.write_bytes(whole.replace(b'"k":12', b'"k":13') if flip else whole[:-30])
    assert "--resume --verify" in run("dataset verify a", 1).stdout
    done = run("sample p.scenic -n 20 -o a --resume" + " --verify" * flip)
    assert "its scenes are made again" in done.stderr
    assert part.read_bytes() == whole
    run("dataset verify a --share 100%")


@pytest.mark.parametrize("name", ["../esc", "a/b", "..", "c:\\d", ""])
def test_sensors_write_into_the_folder(run: Run, tmp_path: Path, name: str) -> None:
    (tmp_path / "camera.scenic").write_text(
        f"from scenic import RGBSensor\nego = new Object with sensors {{{name!r}: RGBSensor(width=8, height=8)}}\nnew Object at (0, 5)\n"
    )
    before = set(tmp_path.iterdir())
    done = run_here(
        ["sample", "camera.scenic", "--seed", 1, "--camera", name, "-o", "images"], folder=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert set(tmp_path.iterdir()) - before == {tmp_path / "images"}
    index = json.loads((tmp_path / "images" / "annotations.json").read_text())
    (image,) = index["images"]
    assert image["camera"] == name
    assert all((tmp_path / "images" / file).is_file() for file in image["files"])
    labels = json.loads((tmp_path / "images" / image["files"][-1]).read_text())
    assert labels["seed"] == image["seed"] == 1


def test_safe_names_differ_as_texts_do() -> None:
    texts = ["a/b", "a_b", "a\\b", "..", ".", "", "a.", "../a", "\ud800", "ü", "a b"]
    names = [safe_name(text) for text in texts]
    assert len({name.lower() for name in names}) == len(texts)
    assert all(name and not set(name) & set("/\\:") and name not in (".", "..") for name in names)
    assert [name for name, text in zip(names, texts, strict=True) if name == text] == ["a_b", "ü", "a b"]


def test_nan_equals_nan(run: Run, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    (tmp_path / "nan.scenic").write_text(PROGRAM + 'param w = float("nan"), v = (1, float("nan"))\n')
    for form in ("parquet", "jsonl"):
        run(f"sample nan.scenic --seed 1 -n 3 --format {form} -o {form}/")
        assert "0 damaged" in run(f"dataset verify {form} --share 100%").stdout


def test_an_absent_object_is_null_in_both_formats(run: Run, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    (tmp_path / "absent.scenic").write_text(
        "other = new Object at (9, 0), with present Uniform(True, False)\n"
        "ego = new Object with friend other, with pair (1, other), with name 'x\\ud800y'\n"
    )
    run("sample absent.scenic --seed 1 -n 12 --properties changed -o s.jsonl")
    run("sample absent.scenic --seed 1 -n 12 -o s.parquet")
    lines = [json.loads(line) for line in (tmp_path / "s.jsonl").read_text().splitlines()]
    rows = parquet.read_table(tmp_path / "s.parquet").to_pylist()
    seen = set()
    for line, row in zip(lines, rows, strict=True):
        ego = line["objects"][line["ego"]]["properties"]
        wanted = {"$object": 1} if len(line["objects"]) == 2 else None
        assert (ego["friend"], ego["pair"]) == (wanted, [1, wanted])
        told = row["objects"][0]["properties"]
        assert (json.loads(told["friend"]), json.loads(told["pair"])) == (wanted, [1, wanted])
        assert told["name"] == "x\ufffdy"
        seen.add(wanted is None)
    assert seen == {True, False}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('"count": "300"', '`count` is "300", not a number of things'),
        ('"part_size": 0', "`part_size` is 0, not a positive integer"),
        ('"seed": null', "`seed` is null, not an integer"),
        ('"parts": [{"file": "../x"}]', '`parts[0].file` is "../x", not the name of a file'),
        ('"images": 3', "`images` is 3, not an object with `cameras`, or null"),
        ('"version": "x"', "`version` is 'x', not an integer"),
    ],
)
def test_a_damaged_manifest_is_named_with_its_field(run: Run, tmp_path: Path, text: str, words: str) -> None:
    run(f"sample p.scenic {JSONL} -n 3 -o a/")
    path = tmp_path / "a" / "manifest.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | json.loads(f"{{{text}}}")))
    for line in ("dataset info a", "dataset verify a", "sample p.scenic -n 3 -o a --resume"):
        error = run(line, 1).stderr
        assert "is damaged" in error
        assert words in error


def test_a_table_is_described_and_other_files_are_not(run: Run, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    run("sample p.scenic --seed 1 -n 3 -o one.parquet")
    assert "3 of 3, from number 0 on" in run("dataset info one.parquet").stdout
    (tmp_path / "broken.parquet").write_text("nothing")
    assert "cannot be read as a Parquet file of scenes" in run("dataset info broken.parquet", 1).stderr
    assert "a data set is a folder" in run("dataset info p.scenic", 1).stderr


def test_an_ambiguous_camera_names_both(run: Run, tmp_path: Path) -> None:
    (tmp_path / "two.scenic").write_text(
        "from scenic import RGBSensor\nego = new Object\nother = new Object at (0, 9), with sensors {'ego': RGBSensor(width=8, height=8)}\n"
    )
    error = run("sample two.scenic --seed 1 --camera ego -o images", 2).stderr
    assert "two cameras are called 'ego': the object 'ego', and a sensor of other" in error
    assert not (tmp_path / "images").exists()


def test_scenes_without_the_camera_are_left_out_and_counted(run: Run, tmp_path: Path) -> None:
    (tmp_path / "some.scenic").write_text(
        "ego = new Object\nother = new Object at (0, 9), with present Uniform(True, False)\n"
    )
    for form in ("images", "tar"):
        done = run(
            f"sample some.scenic --seed 1 -n 8 --image-size 8x8 --camera other --format {form} -o {form}"
        )
        parts = json.loads((tmp_path / form / "manifest.json").read_text())["parts"]
        skipped = sum(part["skipped"] for part in parts)
        assert 0 < skipped < 8
        assert f"{skipped} images are not there" in done.stderr
        assert "0 damaged" in run(f"dataset verify {form} --share 100%").stdout


def test_a_camera_that_is_not_finite_is_an_error_at_its_line(run: Run, tmp_path: Path) -> None:
    (tmp_path / "nan.scenic").write_text(
        'from scenic import RGBSensor\nego = new Object with sensors {"a": RGBSensor(offset=(float("nan"), 0, 0))}\n'
    )
    error = run("sample nan.scenic --seed 1", 1).stderr
    assert "nan.scenic:2" in error
    assert "three finite numbers" in error
