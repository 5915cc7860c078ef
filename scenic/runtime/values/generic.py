"""Operations that values need and modules above carry out: coercions, calls of Python code, samples without a scenario.

Each is declared here, and registered once by the module that carries it out, for any value.
"""

from functools import singledispatch
from typing import Any

from scenic.language.errors import InternalError

__all__ = ["as_orientation", "as_vector", "call_later", "sample_of", "support_of"]


@singledispatch
def call_later(function: object, /, *args: Any, **keywords: Any) -> Any:  # noqa: ARG001
    """The random value of a call that is made on each sample (`scenic.runtime.python.opaque`)."""
    raise InternalError("no module has registered calls on samples")


@singledispatch
def sample_of(value: object) -> Any:  # noqa: ARG001
    """A single sample of a value, drawn now (`scenic.runtime.python.single_samples`)."""
    raise InternalError("no module has registered samples of values")


@singledispatch
def support_of(value: object) -> tuple[float | None, float | None]:  # noqa: ARG001
    """Return the least and the greatest value that a number can have (`scenic.runtime.python.single_samples`)."""
    raise InternalError("no module has registered supports of values")


@singledispatch
def as_vector(value: object) -> Any:  # noqa: ARG001
    """A value read as a vector (`scenic.runtime.values.coercions`)."""
    raise InternalError("no module has registered what vectors are")


@singledispatch
def as_orientation(value: object) -> Any:  # noqa: ARG001
    """A value read as an orientation (`scenic.runtime.values.coercions`)."""
    raise InternalError("no module has registered what orientations are")
