"""Random values: what is drawn when a scene is sampled. Each wraps a node of the value graph.

Here stands what all of them share, and what operations on values need to know. The classes that programs see, with their methods,
stand on the operations (`scenic.runtime.values.random_values`), and register themselves here by the kind of their nodes.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Any, ClassVar

from scenic.graph.kinds import Kind
from scenic.graph.node import Node
from scenic.language.errors import RandomControlFlowError, RandomIndexError, ScenicTypeError
from scenic.runtime.ground.context import here, warn
from scenic.runtime.values.source_text import spelled

__all__ = ["RandomBase", "is_random", "random_value"]


class RandomBase:
    """A value that is drawn when a scene is sampled.

    Anything that needs a definite answer now (a truth value, a comparison, iteration) raises `RandomControlFlowError`.
    """

    __slots__ = ("_again", "node")
    _registered: ClassVar[dict[Kind | None, type["RandomBase"]]] = {}
    """The class of random values of each kind of nodes, that of all other kinds under ``None``."""
    __array_priority__ = 1000  # NumPy scalars on the left defer to the methods of random values.

    def __init_subclass__(cls, *, kinds: Iterable[Kind | None] = (), **options: Any) -> None:
        super().__init_subclass__(**options)
        RandomBase._registered.update(dict.fromkeys(kinds, cls))

    def __init__(self, node: Node, again: "Callable[[], Any] | None" = None) -> None:
        self.node = node
        self._again = again

    @property
    def isPrimitive(self) -> bool:
        """Return whether it is drawn itself, not computed from what is drawn."""
        return self._again is not None

    def clone(self) -> Any:
        """An independent draw of the same law."""
        return self if self._again is None else self._again()

    # What a random value cannot do

    def _definite(self, what: str) -> RandomControlFlowError:
        return RandomControlFlowError(
            f"{what} a random value is not possible while the scenario is being built",
            span=here(),
            help="its value is known only in a sampled scene; use `require`, or make the choice itself "
            "random with `Uniform(...)` or `Discrete({...})`",
        )

    def __bool__(self) -> bool:
        raise self._definite("branching on the truth of")

    def __eq__(self, other: object) -> bool:
        raise self._definite("comparing")

    def __ne__(self, other: object) -> bool:
        raise self._definite("comparing")

    def __lt__(self, other: object) -> bool:
        raise self._definite("comparing")

    def __le__(self, other: object) -> bool:
        raise self._definite("comparing")

    def __gt__(self, other: object) -> bool:
        raise self._definite("comparing")

    def __ge__(self, other: object) -> bool:
        raise self._definite("comparing")

    def __contains__(self, item: object) -> bool:
        raise self._definite("looking into")

    def __iter__(self) -> Iterator[Any]:
        raise self._definite("iterating over")

    def __len__(self) -> int:
        raise self._definite("taking Python's own `len` of")

    def __index__(self) -> int:
        raise RandomIndexError(
            "indexing a container of Python's own with a random value is not possible",
            span=here(),
            help="make the container itself random: `Uniform(xs)[index]`, or choose an element: `Uniform(*xs)`",
        )

    def __int__(self) -> int:
        raise self._definite("converting (outside Scenic code)")

    def __float__(self) -> float:
        raise self._definite("converting (outside Scenic code)")

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return spelled(self.node)

    def __format__(self, spec: str) -> str:
        warn("a random value formatted as text shows no sample")
        return repr(self)

    def resampled(self) -> Any:
        """An independent draw of the same law with the same parameters (``resample``)."""
        if self._again is None:
            raise ScenicTypeError(
                "only primitive distributions can be resampled, not values computed from them",
                span=here(),
                help="resample the distribution itself and compute with the result",
            )
        return self._again()


def random_value(node: Node, again: Callable[[], Any] | None = None) -> Any:
    """Return the random value of a node; ``again`` makes an independent draw of the same law."""
    classes = RandomBase._registered
    return classes.get(node.kind, classes[None])(node, again)


def is_random(value: object, within: tuple[int, ...] = ()) -> bool:
    """Return whether a value is random or a container with random parts; ``within``: the identities of those that hold it."""
    if isinstance(value, RandomBase):
        return True
    parts: Iterable[Any]
    if isinstance(value, tuple | list | set | frozenset):
        parts = value
    elif isinstance(value, slice):
        parts = (value.start, value.stop, value.step)
    elif type(value) is dict:
        parts = (*value, *value.values())
    else:
        return False
    identity = id(value)
    return identity not in within and any(is_random(item, (*within, identity)) for item in parts)
