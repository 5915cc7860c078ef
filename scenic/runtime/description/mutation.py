"""Mutation: noise on objects, drawn with the scene (section 10.5 of the specification).

The noise of the built-in mutators is a draw of the graph like any other. A mutator of the program's own is Python code, called
on sampled objects.
"""

from collections.abc import Iterable, Mapping
from typing import Any

from scenic.graph.kinds import Kind
from scenic.language.errors import ScenicTypeError
from scenic.runtime.description.outcome import Program
from scenic.runtime.ground.context import current, here
from scenic.runtime.instances.mutators import BUILT_IN, KEPT, active, applied, is_built_in
from scenic.runtime.instances.objects import Point
from scenic.runtime.instances.placeholders import complete
from scenic.runtime.instances.properties import update
from scenic.runtime.python.opaque import call_later, see_mutated
from scenic.runtime.values.values import (
    Orientation,
    Vector,
    describe,
    is_number,
    is_random,
    operate,
    to_orientation,
    to_vector,
)


def request(targets: Iterable[object], scale: object) -> None:
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
    """Mutate all instances with a mutation scale, when the program has ended; requirements then apply to the mutated instances."""
    has_mutations = False
    context = current.get()
    for instance in program.instances:
        scale = instance.__dict__["mutationScale"]
        if is_random(scale) or scale != 0:
            if context is not None:
                context.concerns, _ = program.places.get(id(instance), (None, None))
            has_mutations |= _mutate(instance, scale)
    if context is not None:
        context.concerns = None
        complete(context)
    if has_mutations and context is not None:
        see_mutated(context)
    if has_mutations:
        program.requirements[:] = [requirement.rebuilt() for requirement in program.requirements]


def mutate_now(instance: Point) -> None:
    """Add noise to an instance whose values are definite, if it has a mutation scale."""
    scale = instance.mutationScale
    if scale == 0:
        return
    for mutator in active(instance):
        if type(mutator) in BUILT_IN:
            update(instance, mutator.noisy(instance, scale))
        else:
            noisy_copy, go_on = applied(mutator, _copy(instance))
            _settle(instance, noisy_copy)
            if not go_on:
                break


def _mutate(instance: Point, scale: object) -> bool:
    mutators = active(instance)
    if is_built_in(mutators):
        for mutator in mutators:
            update(instance, mutator.noisy(instance, scale))
    else:
        update(instance, _by_python(instance, mutators))
    return bool(mutators)


def _by_python(instance: Point, mutators: list[Any]) -> Mapping[str, Any]:
    """Return the properties after mutators of the program: one call on each sample."""
    names = _free(instance)
    result = call_later(_applied, _copy(instance), tuple(mutators), tuple(names))
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


def _copy(instance: Point) -> Point:
    """Return a copy of an instance that a mutator of the program may change in place."""
    return type(instance)._make(instance.__dict__)


def _settle(instance: Point, changed: object) -> None:
    """Give an instance what a mutator has made of its properties, and what follows from them."""
    update(instance, {name: getattr(changed, name) for name in _free(instance) if name not in KEPT})


def _free(instance: Point) -> list[str]:
    """Return the properties that do not always follow from others."""
    derived = {name for name, entry in instance.scenic_properties.items() if entry.dynamic and entry.final}
    return [name for name in instance.properties if name not in derived]


def _kind(value: object) -> Kind | None:
    return value.node.kind if hasattr(value, "node") else None


def _applied(instance: Any, mutators: tuple[Any, ...], names: tuple[str, ...]) -> tuple[Any, ...]:
    for mutator in mutators if instance.mutationScale != 0 else ():
        instance, go_on = applied(mutator, instance)
        if not go_on:
            break
        _settle(instance, instance)
    return tuple(getattr(instance, name) for name in names)


__all__ = ["apply_noise", "mutate_now", "request"]
