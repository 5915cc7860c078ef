"""Objectives of a search: robustness of requirements, records, expressions, functions."""

import ast
import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.language.errors import Located
from scenic.language.spelling import nearest
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.temporal.robustness import joint_margin

__all__ = ["Objective", "ObjectiveError"]


class ObjectiveError(Located):
    """An objective that cannot be evaluated."""

    code = "SC604"


_NAMES: Final[Mapping[str, Any]] = MappingProxyType(
    {
        **{name: getattr(math, name) for name in ("sqrt", "hypot", "sin", "cos", "exp", "log", "pi", "inf")},
        "min": min,
        "max": max,
        "sum": sum,
        "abs": abs,
        "len": len,
        "round": round,
        "sorted": sorted,
        "range": range,
        "zip": zip,
        "any": any,
        "all": all,
        "float": float,
        "int": int,
    }
)
"""Names that an expression may use beside records and parameters."""

_LEAST: Final = math.ulp(0.0)
"""The least number above 0."""


@dataclass(frozen=True)
class Objective:
    """The quantity to make small; by default the least robustness of all temporal requirements.

    Attributes:
        name: of a requirement (its label, or ``line 3``), of a ``record final``, or, of scenes, of a parameter.
        expression: over records, as lists of their values, or of scenes over parameters, ``ego`` and ``objects``.
        function: called with the result of a simulation, or with a scene.
        is_verdict: whether the value of a requirement is 0 or less exactly where it is violated; then a requirement that a
            simulation never evaluates has the value infinity.

    """

    name: str | None = None
    expression: str | None = None
    function: Callable[[Any], float] | None = None
    is_verdict: bool = False

    @property
    def label(self) -> str:
        """The name of the objective in reports."""
        if self.function is not None:
            return getattr(self.function, "__name__", "function")
        return self.expression or self.name or ("requirements" if self.is_verdict else "robustness")

    def of_simulation(self, result: Any, params: Mapping[str, object]) -> float:
        """The value of a simulation's result; raises `ObjectiveError`."""
        if self.function is not None:
            return _number(self.function(result), self.label)
        if self.is_verdict:
            requirements = (item for item in result.requirements if self.name is None or self._means(item))
            values = (_by_verdict(item, item.robustness) for item in requirements if item.verdict is not None)
            return min(values, default=math.inf)
        records = {name: _values(value) for name, value in result.records.items()}
        if self.expression is not None:
            return self._evaluated({**params, **records})
        outcomes = [item for item in result.requirements if item.robustness is not None]
        if self.name is None:
            if not outcomes:
                raise ObjectiveError(
                    "the simulations follow no requirement, so that there is no robustness to make small",
                    help="write `require always ...`, name an objective: --minimize EXPRESSION, or search scenes alone: --static",
                )
            return min(float(item.robustness) for item in outcomes)
        for item in outcomes:
            if self._means(item):
                return float(item.robustness)
        if self.name in records:
            return _number(records[self.name], self.name)
        if self.name in params:
            raise ObjectiveError(
                f"the objective {self.name!r} is a parameter of the scenes, and nothing of simulations",
                help=f"search scenes alone: --static; or minimise it as an expression: --minimize {self.name}",
            )
        names = [*(item.label for item in outcomes), *records]
        raise _unknown(self.name, names, "is neither a requirement nor recorded", "record ... as {}")

    def distance_of_simulation(self, result: Any, params: Mapping[str, object], threshold: float) -> float:
        """Return by how much a simulation misses a failure, where failures need several parts to fail at once.

        It is 0 or less exactly where the value is at most ``threshold``. Parts are those of an ``or`` in a requirement, and of an expression
        ``max(...)``.
        """
        if self.is_verdict and threshold == 0:
            requirements = (item for item in result.requirements if self.name is None or self._means(item))
            distances = (_by_verdict(item, item.joint) for item in requirements if item.verdict is not None)
            return min(distances, default=math.inf)
        value = self.of_simulation(result, params)
        records = {name: _values(record) for name, record in result.records.items()}
        return self._distance(value, {**params, **records}, threshold)

    def distance_of_scene(self, scene: Scene, threshold: float) -> float:
        """Return by how much a scene misses a failure; see `distance_of_simulation`."""
        names = {**scene.params, "ego": scene.egoObject, "objects": scene.objects}
        return self._distance(self.of_scene(scene), names, threshold)

    def _distance(self, value: float, names: Mapping[str, object], threshold: float) -> float:
        distance = value - threshold
        parts = None if self.expression is None else _parts_of(self.expression)
        if parts is None or not 0 < distance < math.inf:
            return distance
        numbers = eval(compile(parts, "<objective>", "eval"), {"__builtins__": {}, **_NAMES, **names})
        joint = joint_margin([float(part) - threshold for part in numbers])
        return joint if joint > 0 else distance

    def _means(self, outcome: Any) -> bool:
        """Return whether the objective names a requirement."""
        return self.name in (outcome.label, f"line {outcome.line}")

    def of_scene(self, scene: Scene) -> float:
        """Return the value of a scene; raises `ObjectiveError`."""
        if self.function is not None:
            return _number(self.function(scene), self.label)
        params = scene.params
        if self.expression is not None:
            return self._evaluated({**params, "ego": scene.egoObject, "objects": scene.objects})
        if self.name is None:
            raise ObjectiveError(
                "a search of scenes needs an objective",
                help="name a parameter (--objective NAME) or an expression (--minimize EXPRESSION), or a --simulator",
            )
        if self.name not in params:
            raise _unknown(self.name, list(params), "is not a parameter of the program", "param {} = ...")
        return _number(params[self.name], self.name)

    def _evaluated(self, names: Mapping[str, object]) -> float:
        assert self.expression is not None
        try:
            code = compile(self.expression, "<objective>", "eval")
            return _number(eval(code, {"__builtins__": {}, **_NAMES, **names}), self.expression)
        except NameError as error:
            raise _unknown(str(error.name), list(names), "is not recorded", "record ... as {}") from None
        except ObjectiveError:
            raise
        except Exception as error:  # whatever the user's expression does
            raise ObjectiveError(
                f"the objective `{self.expression}` fails: {type(error).__name__}: {error}",
                help="it is Python over records (lists of values) and parameters",
            ) from error


def _parts_of(expression: str) -> ast.Expression | None:
    """Return an expression for the parts of a maximum; ``None`` if an expression is something else."""
    match ast.parse(expression, mode="eval").body:
        case ast.Call(func=ast.Name(id="max"), args=[series], keywords=[]) if not isinstance(
            series, ast.Starred
        ):
            return ast.Expression(series)
        case ast.Call(func=ast.Name(id="max"), args=parts, keywords=[]):
            return ast.fix_missing_locations(ast.Expression(ast.Tuple(parts, ast.Load())))
    return None


def _by_verdict(outcome: Any, robustness: float | None) -> float:
    """Return a robustness of a requirement, with the sign of its verdict also where it is 0 or unknown."""
    value = math.nan if robustness is None else float(robustness)
    if outcome.verdict:
        return max(value, _LEAST) if value == value else math.inf
    return min(value, 0.0) if value == value else -math.inf


def _unknown(name: str, known: Sequence[str], words: str, added: str) -> ObjectiveError:
    near = nearest(name, known)
    if near:
        advice = f"did you mean {near!r}?"
    elif name.isidentifier():
        advice = f"there are: {', '.join(known) or 'none'}; add `{added.format(name)}`"
    else:
        advice = f"there are: {', '.join(known) or 'none'}; minimise an expression by --minimize {name!r}"
    return ObjectiveError(f"the objective {name!r} {words}", help=advice)


def _values(record: object) -> Any:
    """Return the values of a series without their times; anything else as it is."""
    if (
        isinstance(record, Sequence)
        and record
        and all(isinstance(item, tuple) and len(item) == 2 for item in record)
    ):
        return [value for _, value in record]
    return record


def _number(value: Any, label: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ObjectiveError(
            f"the objective `{label}` is no number, but {type(value).__name__}",
            help=f"reduce a series to one number: --minimize 'min({label if label.isidentifier() else 'distance'})'",
        ) from None
