"""Scenes as a data set of PyTorch, made while a model trains; PyTorch is needed only for this module.

```python
from torch.utils.data import DataLoader

from scenic.torch import SceneStream

stream = SceneStream("examples/indoor/desk.scenic", seed=1, count=100_000, transform=features, block=32)
loader = DataLoader(stream, batch_size=32, num_workers=4)
```
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from scenic.language.errors import RejectionException, UnsupportedError
from scenic.pipeline import load
from scenic.runtime.ground.arguments import whole_number
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario

try:
    from torch import int64, zeros
    from torch.utils.data import IterableDataset, get_worker_info
except ImportError as error:
    raise UnsupportedError(
        "data sets of PyTorch need the package torch", help="install it as https://pytorch.org tells"
    ) from error

__all__ = ["SceneStream"]


class SceneStream(IterableDataset):  # type: ignore[misc] # PyTorch is not there when types are checked
    """The scenes of a seed, shared by the workers of a `torch.utils.data.DataLoader`, and by the processes of a distributed job.

    Scenes are dealt out in blocks of consecutive numbers. Which scenes there are depends on neither the number of workers nor
    that of processes; with one process and blocks as large as the loader's batches, their order does not, either.

    Args:
        scenario: a scenario, or the path of a program.
        seed: of the scenes.
        count: how many scenes an epoch has in all processes together; without end if ``None``.
        first: number of the first scene.
        transform: makes of a scene what the loader collects, in the worker. Without it the stream gives the scenes themselves, which a
            loader takes with ``batch_size=None`` or a ``collate_fn``.
        block: scenes that a worker makes one after the other.
        rank: the number of this process among those of a distributed job.
        world_size: how many such processes there are.
        options: for `Scenario.stream`.

    """

    def __init__(
        self,
        scenario: Scenario | str | Path,
        *,
        seed: int,
        count: int | None = None,
        first: int = 0,
        transform: Callable[[Any], Any] | None = None,
        block: int = 64,
        rank: int = 0,
        world_size: int = 1,
        **options: Any,
    ) -> None:
        for name, value, least in (
            ("seed", seed, None),
            ("first", first, 0),
            ("count", 0 if count is None else count, 0),
            ("block", block, 1),
            ("rank", rank, 0),
            ("world_size", world_size, 1),
        ):
            whole_number(value, name, least)
        if rank >= world_size:
            raise ValueError(f"there is no process {rank} of {world_size}: they count from 0")
        self.scenario = scenario if isinstance(scenario, Scenario) else load(scenario)
        self._seed = seed
        self._count = count
        self._first = first
        self._transform = transform
        self._block = block
        self._rank = rank
        self._world_size = world_size
        self._options = options
        # In memory that workers share, so that those that live on between epochs see a change.
        self._epoch = zeros((), dtype=int64).share_memory_()

    def set_epoch(self, epoch: int) -> None:
        """Let the next iteration give the scenes of an epoch, from 0: those that come after the epochs before.

        Workers that live on between epochs (``persistent_workers``) follow it, too.
        """
        if self._count is None:
            raise ValueError("a stream without end has no epochs: give it a `count`")
        self._epoch.fill_(whole_number(epoch, "epoch", 0))

    def __iter__(self) -> Iterator[Any]:
        """The share of this worker.

        Raises:
            RejectionException: if a scene is not found within the limits.

        """
        for first, last in self._blocks():
            for scene in self.scenario.stream(last - first, seed=self._seed, first=first, **self._options):
                if isinstance(scene, Exhausted):
                    raise RejectionException(scene.message())
                yield scene if self._transform is None else self._transform(scene)

    def _blocks(self) -> Iterator[tuple[int, int]]:
        """The numbers of the first scene of each block of this worker, and of the scene after its last."""
        info = get_worker_info()
        worker, workers = (0, 1) if info is None else (info.id, info.num_workers)
        first = self._first + (self._count or 0) * int(self._epoch)
        end = None if self._count is None else first + self._count
        number = self._rank * workers + worker
        while True:
            start = first + number * self._block
            if end is not None and start >= end:
                return
            yield start, start + self._block if end is None else min(start + self._block, end)
            number += self._world_size * workers
