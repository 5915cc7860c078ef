"""Mutation: noise on objects, drawn with the scene (section 10.5 of the specification).

The noise of the built-in mutators is a draw of the graph like any other. A mutator of the program's own is Python code, called
on sampled objects.
"""

from collections.abc import Iterable, Mapping
from typing import Any

from scenic.graph.kinds import Kind
from scenic.language.errors import ScenicTypeError
from scenic.runtime.context import current, here
from scenic.runtime.mutators import BUILT_IN, KEPT, active, applied, is_built_in
from scenic.runtime.objects import Point
from scenic.runtime.opaque import call_later, see_mutated
from scenic.runtime.program import Program
from scenic.runtime.properties import update
from scenic.runtime.standing import complete
from scenic.runtime.values import (
    Orientation,
    Vector,
    describe,
    is_number,
    is_random,
    operate,
    to_orientation,
    to_vector,
)


def request(targets: Iterable[Any], scale: Any) -> None:
    """Set the scale of the noise of instances: what ``mutate`` does."""
    if not is_number(scale):
        raise ScenicTypeError(
            f"`mutate ... by` needs a fixed number, not {describe(scale)}",
            span=here(),
            help="for a random scale write `with mutationScale ...` in the definition of the object",
        )
    for target in targets:
        if not isinstance(target, Point):
            raise ScenicTypeError(f"`mutate` needs points or objects, not {describe(target)}", span=here())
        target.__dict__["mutationScale"] = float(scale)


def apply_noise(program: Program) -> None:
    """Mutate all instances that ask for it, when the program has ended; requirements are then about what comes out."""
    mutated = False
    context = current.get()
    for instance in program.instances:
        scale = instance.__dict__["mutationScale"]
        if is_random(scale) or scale != 0:
            if context is not None:
                context.concerns, _ = program.places.get(id(instance), (None, None))
            mutated |= _mutate(instance, scale)
    if context is not None:
        context.concerns = None
        complete(context)
    if mutated and context is not None:
        see_mutated(context)
    if mutated:
        program.requirements[:] = [requirement.rebuilt() for requirement in program.requirements]


def mutate_now(instance: Point) -> None:
    """Add noise to an instance whose values are definite, if it asks for it."""
    scale = instance.mutationScale
    if scale == 0:
        return
    given = instance.mutator
    for mutator in given if isinstance(given, tuple | list) else (given,):
        if type(mutator) in BUILT_IN:
            update(instance, mutator.noisy(instance, scale))
        elif mutator is not None:
            _, go_on = applied(mutator, instance)
            if not go_on:
                break


def _mutate(instance: Point, scale: Any) -> bool:
    mutators = active(instance)
    if is_built_in(mutators):
        for mutator in mutators:
            update(instance, mutator.noisy(instance, scale))
    else:
        update(instance, _by_python(instance, mutators))
    return bool(mutators)


def _by_python(instance: Point, mutators: list[Any]) -> Mapping[str, Any]:
    """The properties after mutators of the program: one call on each sample."""
    derived = {name for name, entry in instance.scenic_properties.items() if entry.dynamic and entry.final}
    names = [name for name in instance.properties if name not in derived]
    before = type(instance)._make(dict(instance.__dict__))
    result = call_later(_applied, before, tuple(mutators), tuple(names))
    changes: dict[str, Any] = {}
    for index, name in enumerate(names):
        old = instance.__dict__[name]
        value = operate("getitem", result, index)
        if isinstance(old, Vector) or _kind(old) is Kind.VECTOR:
            value = to_vector(value)
        elif isinstance(old, Orientation) or _kind(old) is Kind.ORIENTATION:
            value = to_orientation(value)
        elif name in KEPT:
            continue
        changes[name] = value
    return changes


def _kind(value: Any) -> Kind | None:
    return value.node.kind if hasattr(value, "node") else None


def _applied(instance: Any, mutators: tuple[Any, ...], names: tuple[str, ...]) -> tuple[Any, ...]:
    for mutator in mutators if instance.mutationScale != 0 else ():
        instance, go_on = applied(mutator, instance)
        if not go_on:
            break
    return tuple(getattr(instance, name) for name in names)


__all__ = ["apply_noise", "mutate_now", "request"]
