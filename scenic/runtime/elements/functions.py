"""Python functions that also take random arguments (section 7.2 of the specification)."""

import builtins
import math
from collections.abc import Callable
from types import FunctionType
from typing import Any

from scenic.language.errors import RandomControlFlowError
from scenic.language.types import SCALAR
from scenic.runtime.ground.context import Emptied, current, here, verbosity
from scenic.runtime.python.opaque import call_later, is_later
from scenic.runtime.python.purity import global_names, is_pure
from scenic.runtime.values.lazy import Lazy, defer, is_lazy
from scenic.runtime.values.values import (
    Random,
    as_node,
    is_number,
    is_random,
    operate,
    options_of,
    over_options,
    wrong_type,
)


def _for_python(function: Callable[..., Any]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Note which of Python's own functions one stands for (`scenic.runtime.python.purity`)."""

    def noted(lifted: Any) -> Callable[..., Any]:
        lifted.__wrapped__ = function
        return lifted  # type: ignore[no-any-return] # what it was given

    return noted


@_for_python(math.sin)
def sin(x: object) -> Any:
    """Return the sine of an angle in radians."""
    return _of_numbers("sin", x)


@_for_python(math.cos)
def cos(x: object) -> Any:
    """Return the cosine of an angle in radians."""
    return _of_numbers("cos", x)


@_for_python(math.tan)
def tan(x: object) -> Any:
    """Return the tangent of an angle in radians."""
    return _of_numbers("tan", x)


@_for_python(math.hypot)
def hypot(*coordinates: Any) -> Any:
    """Return the Euclidean length of a vector given by its coordinates."""
    return _of_numbers("hypot", *coordinates)


def _of_numbers(name: str, *operands: Any) -> Any:
    if is_lazy(operands):
        return defer(_of_numbers, name, *operands)
    for item in operands:
        if not (is_number(item) or (isinstance(item, Random) and _may_be_number(item))):
            raise wrong_type(SCALAR, item, f"`{name}`")
    return operate(name, *operands)


def _may_be_number(value: Random) -> bool:
    return value.node.kind.is_number or value.node.kind.is_boxed


def _extreme(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
    def extreme(*args: Any, **options: Any) -> Any:
        if is_lazy(args) or is_lazy(options):
            return defer(extreme, *args, **options)
        if options or isinstance(args[0] if len(args) == 1 else None, Random):
            if not is_later(*args, *options.values()):
                return function(*args, **options)
            choice = None if options else over_options([as_node(item) for item in args], function)
            return call_later(function, *args, **options) if choice is None else choice
        if not any(is_random(item) for item in args):
            return function(*args)
        return operate(name, *(args[0] if len(args) == 1 else args))

    extreme.__name__ = function.__name__
    extreme.__doc__ = function.__doc__
    return _for_python(function)(extreme)


max = _extreme("maximum", builtins.max)
min = _extreme("minimum", builtins.min)


@_for_python(builtins.round)
def round(number: Any, ndigits: Any = None) -> Any:
    """Python's ``round``, also of random numbers."""
    if is_lazy((number, ndigits)):
        return defer(round, number, ndigits)
    if is_random(number) or is_random(ndigits):
        return operate("round", number) if ndigits is None else operate("round", number, ndigits)
    return builtins.round(number, ndigits)


@_for_python(builtins.len)
def len(value: Any) -> Any:
    """Return what Python's ``len`` does; the container may be random."""
    if isinstance(value, Lazy):
        return defer(len, value)
    return operate("len", value) if isinstance(value, Random) else builtins.len(value)


def filter(function: Callable[[Any], Any] | None, values: Any) -> Any:
    """Return the elements for which ``function`` holds, as a list; ``values`` may be random."""
    if is_lazy(values):
        return defer(filter, function, values)
    if not is_later(function, values):
        values = list(values)
        items = _kept(function, values)
        if not items:
            _note_empty(items, values, function)
        return items
    choice = _kept_of_options(function, values)
    if choice is None:
        return call_later(_kept, function, values)
    if all(option == [] for option in options_of(choice)):
        _note_empty(choice, [item for option in options_of(values) for item in option], function)
    return choice


def _note_empty(result: object, elements: list[Any], function: object) -> None:
    """Record the filter that left none of some elements, for the error of a choice from its result."""
    context = current.get()
    if context is not None and context.is_symbolic:
        context.record.emptied.append(Emptied(result, elements, function, here()))


def _kept_of_options(function: Callable[[Any], Any] | None, values: object) -> Any:
    """Filter each option of a random choice; return the kept items as a choice, or ``None`` if only sampling can decide.

    Random names that the function reads have to be choices by the same draw.
    """
    scope = getattr(function, "__globals__", {})
    random_globals = {
        name: scope[name] for name in global_names(function) if isinstance(scope.get(name), Random)
    }
    if function is not None and not is_pure(function, random_globals):
        return None

    def kept(items: object, *given: Any) -> list[Any]:
        if not given:
            return _kept(function, items)
        names = {**scope, **dict(zip(random_globals, given, strict=True))}
        return _kept(FunctionType(function.__code__, names, argdefs=function.__defaults__), items)  # type: ignore[union-attr] # it reads names

    return over_options([as_node(values), *map(as_node, random_globals.values())], kept)


def _kept(function: Callable[[Any], Any] | None, values: Any) -> list[Any]:
    return list(builtins.filter(function, values))


def range(*bounds: Any) -> Any:
    """Return Python's ``range``; raises `RandomControlFlowError` for random bounds."""
    if any(is_random(bound) for bound in bounds):
        raise RandomControlFlowError(
            "`range` needs definite bounds",
            span=here(),
            help="for a random number of objects make the most there can be, each `with present i < count`; "
            "for a random integer write `DiscreteRange(low, high)`",
        )
    return builtins.range(*bounds)


def convert(name: str, *given: Any) -> Any:
    """Call ``int``, ``float`` or ``str`` for a program; the arguments may be random."""
    if is_lazy(given):
        return defer(convert, name, *given)
    function: Callable[..., Any] = {"int": int, "float": float, "str": str}[name]
    if not is_later(*given):
        return function(*given)
    value, *rest = given
    known = isinstance(value, Random) and (name == "str" or _may_be_number(value))
    return operate(name, value) if known and not rest else call_later(function, *given)


def distributionFunction(function: Callable[..., Any]) -> Callable[..., Any]:
    """Make a Python function take random arguments: it is then called with their sampled values."""

    def lifted(*args: Any, **keywords: Any) -> Any:
        if is_lazy(args) or is_lazy(keywords):
            return defer(lifted, *args, **keywords)
        if not is_random(args) and not is_random(keywords):
            return function(*args, **keywords)
        return call_later(function, *args, **keywords)

    lifted.__name__ = getattr(function, "__name__", "lifted")
    lifted.__doc__ = function.__doc__
    return lifted


def verbosePrint(
    *values: Any,
    level: int = 1,
    indent: bool = True,
    sep: str = " ",
    end: str = "\n",
    file: Any = None,
    flush: bool = False,
) -> None:
    """Print as Python does where the verbosity is at least ``level``; the text is indented, so that it stands out from results."""
    if verbosity.get() >= level:
        text = sep.join(map(builtins.str, values))
        lead = "  " if indent else ""
        print(lead + text.replace("\n", "\n" + lead), end=end, file=file, flush=flush)
