"""Scenes as a data set of PyTorch, over what it documents of data sets and workers; over PyTorch itself where it is there."""

import pickle
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from itertools import islice, zip_longest
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import scenic
from scenic.language.errors import RejectionException, UnsupportedError

SCENARIO = scenic.scenarioFromString("ego = new Object at (Range(0, 1), 0)\nrequire ego.position.x > 0.3")
KEPT = ("torch", "torch.utils", "torch.utils.data", "scenic.torch")


def number(scene: Any) -> int:
    return int(scene.k)


class Number:
    """A tensor of one number, as far as a stream uses it."""

    def __init__(self, *_: Any, **__: Any) -> None:
        self.value = 0

    def share_memory_(self) -> "Number":
        return self

    def fill_(self, value: int) -> None:
        self.value = value

    def __int__(self) -> int:
        return self.value


class Workers:
    """PyTorch's documented interface: an iterable data set asks which worker of how many it is in."""

    def __init__(self) -> None:
        self.info: SimpleNamespace | None = None
        data = ModuleType("torch.utils.data")
        data.IterableDataset = type("IterableDataset", (), {})  # type: ignore[attr-defined]
        data.get_worker_info = lambda: self.info  # type: ignore[attr-defined]
        top = ModuleType("torch")
        top.zeros, top.int64 = Number, int  # type: ignore[attr-defined]
        self.modules = {
            "torch": top,
            "torch.utils": ModuleType("torch.utils"),
            "torch.utils.data": data,
        }

    def shares(self, stream: Any, count: int) -> list[list[Any]]:
        """What each of several workers gives; every one has a copy of its own."""
        found = []
        for worker in range(count):
            self.info = SimpleNamespace(id=worker, num_workers=count)
            found.append(list(stream))
        self.info = None
        return found


@pytest.fixture
def workers(monkeypatch: pytest.MonkeyPatch) -> Iterator[Workers]:
    made = Workers()
    for name in KEPT:
        monkeypatch.delitem(sys.modules, name, raising=False)
    for name, module in made.modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    yield made
    sys.modules.pop("scenic.torch", None)


def test_workers_share_the_scenes_of_the_seed(workers: Workers) -> None:
    from scenic.torch import SceneStream

    alone = [scene.egoObject.position.x for scene in SCENARIO.sample(23, seed=5)]
    stream = SceneStream(
        SCENARIO, seed=5, count=23, transform=lambda scene: scene.egoObject.position.x, block=4
    )
    assert list(stream) == alone
    for count in (1, 2, 3, 7):
        shares = workers.shares(stream, count)
        assert sorted(value for share in shares for value in share) == sorted(alone)
        # A loader takes batches from its workers in turn.
        batches = [[share[start : start + 4] for start in range(0, len(share), 4)] for share in shares]
        turns = [batch for turn in zip_longest(*batches, fillvalue=[]) for batch in turn]
        assert [value for batch in turns for value in batch] == alone


def test_processes_epochs_and_endless_streams(workers: Workers) -> None:
    from scenic.torch import SceneStream

    found = [
        value
        for rank in range(3)
        for share in workers.shares(
            SceneStream(
                SCENARIO, seed=5, count=20, first=100, transform=number, block=2, rank=rank, world_size=3
            ),
            2,
        )
        for value in share
    ]
    assert sorted(found) == list(range(100, 120))
    stream = SceneStream(SCENARIO, seed=5, count=6, transform=number)
    stream.set_epoch(2)
    assert list(stream) == list(range(12, 18))
    endless = SceneStream(SCENARIO, seed=5, transform=number, block=3)
    assert list(islice(endless, 10)) == list(range(10))
    with pytest.raises(ValueError, match="without end has no epochs"):
        endless.set_epoch(1)
    with pytest.raises(ValueError, match="process 2 of 2"):
        SceneStream(SCENARIO, seed=5, rank=2, world_size=2)
    for name in ("first", "count", "block", "rank"):
        for value in (-1, 1.5):
            with pytest.raises(ValueError, match=f"`{name}` must be an integer of at least ., not {value}"):
                SceneStream(SCENARIO, **{"seed": 5, name: value})
    for epoch in (-1, 0.5):
        with pytest.raises(ValueError, match=f"`epoch` must be an integer of at least 0, not {epoch}"):
            stream.set_epoch(epoch)
    # Workers that are started anew get the stream in a pickle.
    assert list(pickle.loads(pickle.dumps(stream))) == list(range(12, 18))
    never = scenic.scenarioFromString(
        "def never(x): return x > 1\nx = Range(0, 1)\nego = new Object at (x, 0)\nrequire never(x)"
    )
    with pytest.raises(RejectionException, match="no scene was found within 50 candidates"):
        list(SceneStream(never, seed=1, count=2, max_attempts=50))


def test_without_pytorch_the_module_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "scenic.torch", raising=False)
    monkeypatch.setitem(sys.modules, "torch", None)
    monkeypatch.setitem(sys.modules, "torch.utils.data", None)
    with pytest.raises(UnsupportedError, match="need the package torch"):
        import scenic.torch  # noqa: F401


REAL = pytest.mark.skipif(find_spec("torch") is None, reason="PyTorch is not installed")


def place(scene: Any) -> float:
    return float(scene.egoObject.position.x)


class Photo:
    """The number of a scene, and the image that its ego takes."""

    def __init__(self) -> None:
        self._photographer: Any = None

    def __call__(self, scene: Any) -> tuple[int, Any]:
        import torch

        from scenic.formats.coco import Photographer

        if self._photographer is None:
            self._photographer = Photographer("ego", (16, 12))
        content = self._photographer.shoot(scene).files[f"ego-{scene.k:06d}-rgb.png"]
        return scene.k, torch.frombuffer(bytearray(content), dtype=torch.uint8)[:64]


@REAL
def test_pytorch_loads_scenes_in_order() -> None:
    from torch.utils.data import DataLoader

    from scenic.torch import SceneStream

    alone = [place(scene) for scene in SCENARIO.sample(20, seed=5)]
    for transform, wanted in ((number, list(range(20))), (place, alone)):
        stream = SceneStream(SCENARIO, seed=5, count=20, transform=transform, block=4)
        for count in (0, 2):
            loader = DataLoader(stream, batch_size=4, num_workers=count)
            assert [value.item() for batch in loader for value in batch] == wanted
    scenes = DataLoader(SceneStream(SCENARIO, seed=5, count=3), batch_size=None)
    assert [place(scene) for scene in scenes] == alone[:3]


@REAL
def test_epochs_reach_workers_that_live_on() -> None:
    from torch.utils.data import DataLoader

    from scenic.torch import SceneStream

    stream = SceneStream(SCENARIO, seed=5, count=6, first=10, transform=number, block=2)
    loader = DataLoader(stream, batch_size=2, num_workers=2, persistent_workers=True)
    for epoch in (0, 1, 3):
        stream.set_epoch(epoch)
        found = [int(value) for batch in loader for value in batch]
        assert found == list(range(10 + 6 * epoch, 10 + 6 * epoch + 6))


@REAL
def test_workers_make_the_same_images() -> None:
    pytest.importorskip("PIL.Image")
    from torch.utils.data import DataLoader

    from scenic.torch import SceneStream

    scenario = scenic.scenarioFromString(
        "ego = new Object with viewAngles (60 deg, 60 deg)\nnew Object at (Range(-1, 1), 4)"
    )
    stream = SceneStream(scenario, seed=5, count=6, transform=Photo(), block=2)
    alone, shared = (
        {
            int(k): image.tolist()
            for numbers, images in DataLoader(stream, batch_size=2, num_workers=count)
            for k, image in zip(numbers, images, strict=True)
        }
        for count in (0, 2)
    )
    assert alone == shared
    assert sorted(alone) == list(range(6))
    assert len({tuple(image) for image in alone.values()}) > 1
