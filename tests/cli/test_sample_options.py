"""Every option of ``scenic sample`` either decides what a data set or a file holds, and is compared by ``--resume``, or does not."""

from pathlib import Path

import pytest

from scenic.cli.sample import sample
from scenic.pipeline import load
from tests.cli.commands import run_here

PROGRAM = """
model scenery
param w = Range(0, 1)
scenario Main():
    setup:
        ego = new Object at (Range(0, 5), Range(0, 1))
        require ego.x > 3
scenario Other():
    setup:
        ego = new Object at (Range(0, 5), Range(0, 1))
"""

DECIDING = {
    "seed": "--seed 2",
    "first": "--first 1",
    "parameters": "-p w=0.5",
    "extra_params": "-p unknown=1 --extra-params",
    "scenario": "--scenario Other",
    "model": "--model landscape",
    "mode_2d": "--2d",
    "no_prune": "--no-prune",
    "sobol": "--sobol",
    "properties": "--properties changed",
}
"""Options that decide a scene or its form, with values that are not those of the first run."""

DECIDING_DATASETS = {
    "max_attempts": "--max-attempts 900",
    "form": "--format usd",
    "part_size": "--part-size 3",
    "cameras": "--camera ego",
}
"""Options that decide parts, or which scenes are not found."""

DECIDING_IMAGES = {
    "image_size": "--camera ego --image-size 8x8",
    "overlay": "--camera ego --image-size 8x6 --overlay",
}
"""Options that decide images."""

NEUTRAL = {
    "jobs": "-j 2",
    "resume": "",
    "accept_changes": "--accept-changes",
    "time_limit": "--time-limit 1000",
    "count": "-n 7",
}
"""Options that change how scenes are made, or how many."""

REFUSED = {
    "approximate": "--approximate 4",
    "sampler": "--sampler halton",
    "minimized": "--sampler halton --minimize w",
    "png": "--png image.png",
    "outlook": "--png image.png --look-from above",
    "frame": "--png image.png --frame objects",
    "view": "--view page.html",
    "profile": "--profile",
}
"""Options that do not go with ``--resume``."""

ELSEWHERE = {
    "file", "output",  # the program and the place themselves
    "dask",  # another engine, like -j
    "verified",  # of data sets, in `tests/batch/folders/test_folder.py`
    "show_params",  # output beside the lines
    "settle", "settle_tolerance",  # see below: they need a simulator
}  # fmt: skip

BASE = "sample p.scenic --seed 1 -n 6"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("options")
    (place / "p.scenic").write_text(PROGRAM)
    (place / "scenery.scenic").write_text("height = 1\n")
    (place / "landscape.scenic").write_text("height = 2\n")
    targets = ("lines.jsonl", "set/ --format jsonl --part-size 4", "images/ --camera ego --image-size 8x6")
    for target in targets:
        done = run_here(f"{BASE} -o {target}".split(), folder=place)
        assert done.returncode == 0, done.stderr
    return place


def contents(place: Path) -> dict[str, bytes]:
    """All files but compiled programs, which any command may leave beside them."""
    files = (path for path in sorted(place.rglob("*")) if path.is_file() and "__pycache__" not in path.parts)
    return {str(path): path.read_bytes() for path in files}


def test_all_options_are_in_one_group() -> None:
    groups = [*DECIDING, *DECIDING_DATASETS, *DECIDING_IMAGES, *NEUTRAL, *REFUSED, *ELSEWHERE]
    options = [item.name for item in sample.params if item.name not in ("no_cache", "help")]
    assert sorted(groups) == sorted(filter(None, options))


@pytest.mark.parametrize(
    ("target", "words"),
    [
        *(("lines.jsonl", words) for words in DECIDING.values()),
        *(("set/", words) for words in {**DECIDING, **DECIDING_DATASETS}.values()),
        *(("images/", words) for words in DECIDING_IMAGES.values()),
    ],
)
def test_options_that_decide_are_compared(folder: Path, words: str, target: str) -> None:
    before = contents(folder)
    done = run_here(f"{BASE} -o {target} --resume {words}".split(), folder=folder)
    assert done.returncode in (1, 2), done.stdout + done.stderr
    assert ("SC609" if target == "lines.jsonl" else "SC612") in done.stderr
    assert contents(folder) == before


@pytest.mark.parametrize("target", ["lines.jsonl", "set/"])
@pytest.mark.parametrize("option", NEUTRAL)
def test_other_options_are_not(folder: Path, tmp_path: Path, option: str, target: str) -> None:
    for name, data in contents(folder).items():
        path = tmp_path / Path(name).relative_to(folder)
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(data)
    done = run_here(f"{BASE} -o {target} --resume {NEUTRAL[option]}".split(), folder=tmp_path)
    assert done.returncode == 0, done.stderr
    if option != "count":
        rows = {name: data for name, data in contents(folder).items() if "manifest" not in name}
        assert {str(folder / Path(name).relative_to(tmp_path)): data for name, data in contents(tmp_path).items()
                if "manifest" not in name} == rows  # fmt: skip


@pytest.mark.parametrize("target", ["lines.jsonl", "set/"])
@pytest.mark.parametrize("option", REFUSED)
def test_options_that_do_not_go_with_resume_are_refused(folder: Path, option: str, target: str) -> None:
    before = contents(folder)
    done = run_here(f"{BASE} -o {target} --resume {REFUSED[option]}".split(), folder=folder)
    assert done.returncode == 2, done.stdout + done.stderr
    assert "go with" in done.stderr or "it goes without" in done.stderr
    assert contents(folder) == before


def test_settling_is_in_the_digest(folder: Path) -> None:
    pytest.importorskip("mujoco")
    scenarios = [
        load(folder / "p.scenic", settle=settle, settle_tolerance=tolerance, settle_keep=is_kept)
        for settle, tolerance, is_kept in (
            (None, 0.01, False),
            (0.1, 0.01, False),
            (0.2, 0.01, False),
            (0.1, 0.02, False),
            (0.1, 0.01, True),
        )
    ]
    assert len({item.digest for item in scenarios}) == 5
