"""Histories of commands over folders, against a model in memory: nothing is lost or mixed with exit code 0, and `verify` is right.

The model holds for every folder the seed, the constant of the imported module and the wanted numbers of its data set. After each command
that succeeded, the lines of all files in the folder are those of the model.
"""

import json
import shutil
import sys
import tempfile
import warnings
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

import scenic
from scenic.batch.datasets import DatasetRun, Finished, Resuming, make_dataset
from scenic.batch.folders.lock import LOCK, BusyError, Lock
from scenic.batch.manifest import NAME, DatasetError, Manifest
from scenic.batch.verifying import merge, verify
from scenic.language.errors import ScenicWarning
from tests.amounts import amount

PROGRAM = "from histlib import LOW\nego = new Object at (Range(LOW, LOW + 5), 0)\n"
NAMES = ("a", "b", "c")


@dataclass
class Content:
    """A data set of the model: `lows` maps the numbers of its scenes to the constant by which they were made."""

    seed: int
    first: int
    count: int
    size: int
    low: int
    lows: dict[int, int] = field(default_factory=dict)
    damaged: set[str] = field(default_factory=set)

    @property
    def numbers(self) -> range:
        return range(self.first, self.first + self.count)


class Killed(BaseException):
    """Stands for the end of the process."""


class Histories(RuleBasedStateMachine):
    """Commands over three folders."""

    def __init__(self) -> None:
        super().__init__()
        self.place = Path(tempfile.mkdtemp())
        self.low = 0
        self.programs: dict[int, Any] = {}
        self.model: dict[str, Content] = {}
        (self.place / "p.scenic").write_text(PROGRAM)
        self.change_constant(0)

    def teardown(self) -> None:
        shutil.rmtree(self.place)
        sys.modules.pop("histlib", None)

    def program(self) -> Any:
        sys.modules.pop("histlib", None)
        shutil.rmtree(self.place / "__pycache__", ignore_errors=True)
        return scenic.load(self.place / "p.scenic")

    def expected(self, content: Content, k: int) -> float:
        """The position of the only object of a scene, from a program that nothing changes."""
        low = content.lows[k]
        if low not in self.programs:
            folder = self.place / f"original {low}"
            folder.mkdir()
            (folder / "p.scenic").write_text(PROGRAM)
            (folder / "histlib.py").write_text(f"LOW = {low}\n")
            sys.modules.pop("histlib", None)
            self.programs[low] = scenic.load(folder / "p.scenic")
        (scene,) = self.programs[low].stream(1, seed=content.seed, first=k)
        return float(scene.egoObject.x)

    @rule(low=st.integers(0, 2))
    def change_constant(self, low: int) -> None:
        self.low = low
        (self.place / "histlib.py").write_text(f"LOW = {low}\n")

    def make(self, name: str, wanted: Manifest, how: bool | Resuming, ended: int | None) -> Finished | None:
        done = 0

        def advance(count: int, attempts: int) -> None:
            nonlocal done
            done += count if attempts else 0
            if ended is not None and done > ended:
                raise Killed

        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ScenicWarning)
                return make_dataset(
                    self.program(), self.place / name, wanted, DatasetRun(advance=advance), resume=how
                )
        except Killed:
            return None

    @rule(
        name=st.sampled_from(NAMES),
        seed=st.integers(1, 2),
        first=st.sampled_from([0, 0, 4, 7]),
        count=st.integers(1, 9),
        size=st.sampled_from([3, 4]),
        resume=st.booleans(),
        verified=st.booleans(),
        accepted=st.booleans(),
        ended=st.none() | st.integers(0, 6),
    )
    def sample(
        self, name: str, seed: int, first: int, count: int, size: int,
        resume: bool, verified: bool, accepted: bool, ended: int | None,
    ) -> None:  # fmt: skip
        """``scenic sample``, perhaps with ``--resume``, perhaps killed."""
        before = self.model.get(name)
        files = self.files(name)
        wanted = Manifest.of(
            self.program(),
            seed=seed,
            first=first,
            count=count,
            part_size=size,
            form="jsonl",
            properties="all",
        )
        is_void = not any(item.startswith("part-") for item in files)
        fits = (
            before is None
            or (is_void and not resume)
            or (
                resume
                and (seed, first, size) == (before.seed, before.first, before.size)
                and count >= before.count
                and (accepted or before.low == self.low)
            )
        )
        try:
            finished = self.make(name, wanted, Resuming(verified, accepted) if resume else False, ended)
        except DatasetError:
            # Something is there that this command must not touch.
            assert not fits
            assert self.files(name) == files
            return
        assert fits
        self.take_up(name, before, files, wanted, finished, verified=verified)

    def take_up(
        self,
        name: str,
        before: Content | None,
        files: dict[str, bytes],
        wanted: Manifest,
        finished: Finished | None,
        *,
        verified: bool,
    ) -> None:
        folder = self.place / name
        if not (folder / NAME).exists():
            assert finished is None
            self.model.pop(name, None)
            return
        manifest = Manifest.load(folder)
        if finished is None and not manifest.parts and before is None and not list(folder.glob("part-*")):
            shutil.rmtree(folder)
            self.model.pop(name, None)
            return
        content = Content(wanted.seed, wanted.first, wanted.count, wanted.part_size, self.low)
        now = self.files(name)
        for part in manifest.parts:
            # A part stays as it is, or is made by the constant of now.
            stays = before is not None and files.get(part.file) == now[part.file]
            for k in range(part.first, part.last):
                content.lows[k] = before.lows[k] if before is not None and stays else self.low
            if before is not None and stays and part.file in before.damaged:
                assert not verified
                content.damaged.add(part.file)
        if finished is not None:
            assert set(content.lows) == set(content.numbers)
        self.model[name] = content

    def files(self, name: str) -> dict[str, bytes]:
        folder = self.place / name
        return {path.name: path.read_bytes() for path in folder.iterdir()} if folder.exists() else {}

    @staticmethod
    def lines(folder: Path) -> list[str]:
        return [
            line
            for path in sorted(folder.glob("*.jsonl"))
            for line in path.read_text(errors="replace").splitlines()
        ]

    @rule(names=st.permutations(NAMES), count=st.integers(1, 3), joined=st.sampled_from(NAMES))
    def merge(self, names: list[str], count: int, joined: str) -> None:
        """``scenic dataset merge`` in any order, with gaps, overlaps and folders that are there."""
        sources = names[:count]
        before = {name: self.files(name) for name in NAMES}
        contents = [self.model.get(name) for name in sources]
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ScenicWarning)
                merge([self.place / name for name in sources], self.place / joined)
        except DatasetError:
            assert {name: self.files(name) for name in NAMES} == before
            return
        assert joined not in self.model
        found = [item for item in contents if item is not None]
        assert len(found) == count
        assert not any(item.damaged for item in found)
        lows = [pair for item in found for pair in item.lows.items()]
        assert len(dict(lows)) == len(lows), "an overlap was joined"
        assert len({(item.seed, item.low) for item in found}) == 1
        first, last = min(item.first for item in found), max(item.numbers.stop for item in found)
        self.model[joined] = Content(
            found[0].seed, first, last - first, found[0].size, found[0].low, dict(lows)
        )
        assert {name: self.files(name) for name in NAMES if name != joined} == {
            name: files for name, files in before.items() if name != joined
        }

    @precondition(lambda self: self.model)
    @rule(data=st.data(), is_cut=st.booleans())
    def damage(self, data: st.DataObject, is_cut: bool) -> None:
        """A part loses its end, or a bit of it flips."""
        name = data.draw(st.sampled_from(sorted(self.model)))
        parts = sorted((self.place / name).glob("*.jsonl"))
        if not parts:
            return
        path = data.draw(st.sampled_from(parts))
        content = path.read_bytes()
        if not content or path.name in self.model[name].damaged:
            return
        if is_cut:
            path.write_bytes(content[: len(content) // 2])
        else:
            place = data.draw(st.integers(0, len(content) - 1))
            path.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
        self.model[name].damaged.add(path.name)

    @precondition(lambda self: self.model)
    @rule(data=st.data())
    def write_beside(self, data: st.DataObject) -> None:
        """A second writer is refused and changes nothing."""
        name = data.draw(st.sampled_from(sorted(self.model)))
        files = self.files(name)
        wanted = replace(Manifest.load(self.place / name), count=20)
        with Lock(self.place / name / LOCK, self.place / name):
            with suppress(BusyError):
                make_dataset(self.program(), self.place / name, wanted, resume=Resuming(True, True))
                raise AssertionError("two commands write one folder")
            held = self.files(name)
        held.pop(LOCK)
        assert held == files

    @invariant()
    def nothing_is_lost_or_mixed(self) -> None:
        for name in NAMES:
            folder = self.place / name
            content = self.model.get(name)
            if content is None:
                assert not list(folder.glob("part-*.jsonl"))
                continue
            damages = {item.file for item in verify(folder, None)}
            assert damages == content.damaged, "verify is wrong"
            if content.damaged:
                continue
            rows = [json.loads(line) for line in self.lines(folder)]
            assert sorted(row["k"] for row in rows) == sorted(content.lows)
            for row in rows:
                assert row["seed"] == content.seed
                assert row["objects"][0]["position"][0] == self.expected(content, row["k"])


def test_histories_lose_nothing() -> None:
    run_state_machine_as_test(
        Histories,
        settings=settings(
            max_examples=amount(6, 2000),
            stateful_step_count=12,
            deadline=None,
            suppress_health_check=list(HealthCheck),
        ),
    )
