"""Scenes as data: the draws by address from which a scene follows, to be kept and taken up again.

A file holds numbers only, never code; the program that made the scene gives them their meaning. A file of another program,
or of the same with other options, is refused.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.draws import Counter, NumberSource, Points
from scenic.graph.node import Graph, Node
from scenic.language.errors import SerializationError
from scenic.runtime.sampling.engine import FinishedLanes
from scenic.runtime.sampling.pending import SceneTask

FORMAT: Final = "scenic scene"
VERSION: Final = 2


@dataclass(frozen=True, slots=True)
class SavedScene:
    """One scene as data.

    ``numbers`` are the points of the cube's axes and ``words`` the keys of further draws, by address. Which soft requirements
    were active follows from the task.
    """

    program: str
    task: SceneTask
    attempts: int
    numbers: Mapping[int, float]
    words: Mapping[int, int]

    def to_bytes(self) -> bytes:
        """Return the data as JSON."""
        data = {
            "format": FORMAT,
            "version": VERSION,
            "program": self.program,
            "seed": self.task.seed,
            "scene": self.task.k,
            "attempts": self.attempts,
            "numbers": {f"{name:016x}": number.hex() for name, number in sorted(self.numbers.items())},
            "words": {f"{name:016x}": f"{word:016x}" for name, word in sorted(self.words.items())},
        }
        body = json.dumps(data, separators=(",", ":")).encode()[:-1]
        return body + _SUM + _sum(body) + b'"}'

    @classmethod
    def from_bytes(cls, data: bytes) -> "SavedScene":
        """Return the scene in the data; raises `SerializationError` for anything that `to_bytes` does not write."""
        try:
            body, mark, rest = bytes(data).rpartition(_SUM)
            if mark and rest != _sum(body) + b'"}':
                raise _broken("its content has changed since it was written")
            content = json.loads(data)
            if content["format"] != FORMAT or content["version"] != VERSION:
                raise _broken("it is of another kind, or another version of the format")
            if not mark:
                raise _broken("it has no checksum")
            numbers = {int(name, 16): float.fromhex(number) for name, number in content["numbers"].items()}
            if not all(0 < number < 1 for number in numbers.values()):
                raise _broken("a draw lies outside of the unit interval")
            return cls(
                str(content["program"]),
                SceneTask(int(content["seed"]), int(content["scene"])),
                int(content["attempts"]),
                numbers,
                {int(name, 16): int(word, 16) for name, word in content["words"].items()},
            )
        except (ValueError, KeyError, TypeError, AttributeError, UnicodeDecodeError) as error:
            raise _broken(f"it is damaged, or not the data of a scene ({error})") from error


_SUM: Final = b',"sum":"'
"""The field that ends the data: a checksum of everything before it."""


def _sum(body: bytes) -> bytes:
    return hashlib.sha256(body).hexdigest()[:32].encode()


def _broken(why: str) -> SerializationError:
    return SerializationError(f"the saved scene cannot be read: {why}", help="save the scene again")


def draws_of(
    found: FinishedLanes, lane: int, nodes: Iterable[Node] | None = None
) -> tuple[dict[int, float], dict[int, int]]:
    """The draws behind a scene that was found, by address: numbers of axes, and words of keys.

    ``nodes`` are some nodes of the graph; all of them by default.
    """
    batch = found.again(lane)
    graph = batch.graph
    drawn_nodes = [node for node in (graph.nodes if nodes is None else nodes) if node.is_drawn]
    batch.need(drawn_nodes)
    numbers: dict[int, float] = {}
    words: dict[int, int] = {}
    for node in drawn_nodes:
        (value,) = batch.column(node).tolist()
        (numbers if node.is_axis else words)[graph.address(node)] = value
    return numbers, words


def source_of(saved: SavedScene, graph: Graph) -> Points:
    """Return the source of one lane that gives the saved draws; raises `SerializationError` if the program has others."""
    if graph.drawn_addresses != saved.numbers.keys() | saved.words.keys():
        raise SerializationError(
            "the saved scene has other random values than this program",
            help="take it up again with the program, and the version of the tools, that made it",
        )
    return fixed_draws(saved.numbers, saved.words, Counter(np.zeros(1, dtype=np.uint64)))


def fixed_draws(numbers: Mapping[int, float], words: Mapping[int, int], rest: NumberSource) -> Points:
    """Return the source in which some draws are fixed in every lane."""

    def rows(values: Mapping[int, float], dtype: type[np.generic]) -> dict[int, NDArray[Any]]:
        column = np.array(list(values.values()), dtype=dtype)[:, np.newaxis]
        return dict(zip(values, np.broadcast_to(column, (len(values), len(rest))), strict=True))

    return Points(rows(numbers, np.float64), rest, rows(words, np.uint64))


def program_digest(text: str, options: Mapping[str, object]) -> str:
    """The digest of a program in its saved scenes: of the text and of how it was compiled."""
    digest = hashlib.sha256(text.encode("utf-8", "surrogatepass"))
    digest.update(repr(sorted(options.items())).encode("utf-8", "surrogatepass"))
    return digest.hexdigest()


__all__ = ["SavedScene", "draws_of", "fixed_draws", "program_digest", "source_of"]
