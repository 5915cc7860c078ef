"""From a program's objects and requirements to the checks of a plan (sections 10.1 and 10.2 of the specification)."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.bounding import forward, overall
from scenic.graph.bounds import Bounds, Floats
from scenic.graph.domain import Domain
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph, Node
from scenic.graph.node_forms import Forms
from scenic.graph.operations.possible_faults import is_finite
from scenic.language.errors import InvalidScenarioError
from scenic.language.spans import Span
from scenic.runtime.description.conditions import connect, truth
from scenic.runtime.description.outcome import Program, Requirement
from scenic.runtime.geometry.contact.collision import collide
from scenic.runtime.geometry.contact.narrowphase import recall
from scenic.runtime.geometry.ragged import distinct
from scenic.runtime.ground.context import warn
from scenic.runtime.instances.objects import Object
from scenic.runtime.python.samples import dependencies
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import as_region
from scenic.runtime.regions.planar_visibility import sees_in_mode
from scenic.runtime.regions.presence import absent, is_always_present
from scenic.runtime.regions.spaces import Everywhere, Nowhere, Workspace
from scenic.runtime.regions.stacked import body_operands
from scenic.runtime.regions.visibility_nodes import looks
from scenic.runtime.sampling.checks import (
    BUILT_IN,
    Check,
    CollisionCheck,
    NodeCheck,
    ObjectNodes,
)
from scenic.runtime.sampling.draw_checks import called, drawing_checks
from scenic.runtime.sampling.engine import Plan
from scenic.runtime.sampling.sizes import extents, outgrows, size_in_words
from scenic.runtime.values.values import CODEC, Random, as_node, fixed_batch, is_random, operate

_SIMULATION: Final = 1e6
"""Cost of a check that simulates, as `Check` has it."""
_FAR: Final = 1e100
"""Metres, or any other unit, that nothing is away."""


@dataclass(frozen=True, slots=True)
class Outline:
    """A plan but for the part of the cube to sample from, which analysis may still narrow."""

    graph: Graph
    checks: tuple[Check, ...]
    outputs: tuple[Node, ...]
    """Values that scenes show. Other values, such as points, are evaluated on demand."""
    requirements: tuple[Requirement, ...]
    """The hard requirements of the program, for analysis."""
    built_in: tuple[NodeCheck, ...]
    """The built-in checks that objects are inside their containers, and that they are visible where required."""
    bodies: int
    """The number of objects."""

    def plan(self, domain: Domain | None = None) -> Plan:
        """The plan on a part of the cube (the whole of it by default)."""
        part = Domain.whole(self.graph.dimension) if domain is None else domain
        return Plan(self.graph, part, self.checks, self.outputs, CODEC, self.bodies)


def outline(program: Program, ego: Object | None, workspace: Workspace, *, mode_2d: bool) -> Outline:
    """Collect the conditions that every scene must satisfy.

    Raises `InvalidScenarioError` where a built-in requirement can be seen to fail in every scene.
    """
    if ego is not None and not is_always_present(ego):
        span, filename = _place(program, ego)
        raise InvalidScenarioError(
            "the ego takes part in every scene, so that its `present` must be True",
            span=span,
            filename=filename,
            help="leave `present` out, or make another object the ego",
        )
    roots = dependencies(program.reachable())
    checks: list[Check] = drawing_checks(roots, program)
    checks += _finite(program)
    checks += _sizes(program)
    built_in = [*_containment(program, workspace), *_visibility(program, ego, mode_2d=mode_2d)]
    checks += built_in
    checks += _collisions(program)
    checks += _requirements(program)
    nodes = [node for check in checks for node in check.nodes]
    graph = Graph([*roots, *nodes])
    outputs = dependencies([*program.objects, *program.parameters.values()])
    hard = tuple(item for item in program.requirements if item.probability == 1)
    return Outline(graph, tuple(checks), tuple(outputs), hard, tuple(built_in), len(program.objects))


def _place(program: Program, item: object) -> tuple[Span | None, str | None]:
    return program.places.get(id(item), (None, None))


def _finite(program: Program) -> list[Check]:
    """Random positions and angles must come out finite."""
    checks: list[Check] = []
    bounds_of: dict[Node, Bounds | None] = {}
    forms, answers = Forms(), dict[int, bool]()
    for item in program.objects:
        span, _ = _place(program, item)
        for value in (item.position, item.yaw, item.pitch, item.roll):
            if not isinstance(value, Random):
                continue
            form = forms.number(value.node)
            if form not in answers:
                answers[form] = _may_be_infinite(value.node, bounds_of)
            if answers[form]:
                size = operate("norm" if value is item.position else "absolute", value)
                # What is undefined is not less than anything.
                node = _if_present(item, truth(operate("less", size, math.inf)))
                checks.append(
                    NodeCheck(node, f"finite position and angles of {called(program, item)}", span, BUILT_IN)
                )
    return checks


def _may_be_infinite(root: Node, known: dict[Node, Bounds | None]) -> bool:
    """Return whether numbers below a node may overflow or be undefined; ``known`` keeps what has been found out.

    Operations that say nothing of their results are those of geometry, whose results are places.
    """
    stack = [root]
    while stack:
        node = stack[-1]
        if node in known:
            stack.pop()
            continue
        if node.is_constant or node.is_drawn:
            known[node] = overall(node)
            continue
        missing = [operand for operand in node.operands if operand not in known]
        if missing:
            stack += missing
            continue
        operands = [known[operand] for operand in node.operands]
        are_overall = all(
            bounds is overall(operand) for bounds, operand in zip(operands, node.operands, strict=True)
        )
        bounds = overall(node) if are_overall else forward(node, operands)
        if node.operation.bounds is None and bounds is not None and not _is_python(node):
            bounds = Bounds(np.maximum(bounds.lower, -_FAR), np.minimum(bounds.upper, _FAR))
        if bounds is not None and _may_be_no_turn(node, operands):
            bounds = Bounds(np.full_like(bounds.lower, -math.inf), np.full_like(bounds.upper, math.inf))
        known[node] = bounds
    bounds_of_root = known[root]
    return bounds_of_root is None or not _is_bounded(bounds_of_root)


def _may_be_no_turn(node: Node, operands: Sequence[Bounds | None]) -> bool:
    """Return whether a value is a rotation by an angle that may be infinite, or such an angle, which bounds of its parts do not show."""
    if node.kind is not Kind.ORIENTATION and node.operation.name != "euler":
        return False
    return any(bounds is not None and not _is_bounded(bounds) for bounds in operands)


def _is_bounded(bounds: Bounds) -> bool:
    return bool(np.isfinite(bounds.lower).all() and np.isfinite(bounds.upper).all())


def _is_python(node: Node) -> bool:
    return node.operation.is_python(node.operands, node.kind)


def _sizes(program: Program) -> list[Check]:
    """Random sizes must come out positive (section 5.3), and finite."""
    checks: list[Check] = []
    for item in program.objects:
        for name in ("width", "length", "height"):
            size = getattr(item, name)
            if is_random(size):
                span, _ = _place(program, item)
                node = truth(operate("less", 0, size))
                bounds = overall(node)
                if bounds is None or bounds.lower[0] != 1:
                    checks.append(
                        NodeCheck(
                            _if_present(item, node),
                            f"positive {name} of {called(program, item)}",
                            span,
                            BUILT_IN,
                        )
                    )
                if not is_finite(as_node(size)):
                    node = truth(operate("less", size, math.inf))
                    checks.append(
                        NodeCheck(
                            _if_present(item, node),
                            f"finite {name} of {called(program, item)}",
                            span,
                            BUILT_IN,
                        )
                    )
    return checks


def _containment(program: Program, workspace: Workspace) -> list[NodeCheck]:
    checks: list[NodeCheck] = []
    footprints: dict[Region, Region] = {}  # one for each region, so that alike checks are made together
    reaches: dict[Region, Floats | None] = {}
    for item in program.objects:
        container = item.regionContainedIn
        region = as_region(container, missing=workspace)
        while isinstance(region, Workspace):
            region = region.region
        if isinstance(region, Everywhere):
            continue
        if region is None:
            raise InvalidScenarioError(
                f"`regionContainedIn` must be a region, not {container!r}", span=_place(program, item)[0]
            )
        if isinstance(region, Nowhere):
            span, filename = _place(program, item)
            raise InvalidScenarioError(
                f"{_subject(program, item)} cannot be inside its container, which is empty",
                span=span,
                filename=filename,
                help="give it another `regionContainedIn`, or another place if that follows from `contained in`",
            )
        if region not in footprints:
            footprints[region] = region.footprint
            reaches[region] = extents(footprints[region])
        containment = _if_present(item, truth(footprints[region].containsObject(item)))
        node = as_node(body_operands(item)[2])
        size = size_in_words(node)
        checks_of_object = _required(
            containment,
            f"{called(program, item)} inside its container",
            _place(program, item),
            f"{_subject(program, item)}{f', {size},' if size else ''} is not inside its container, {region!r}",
            "move or shrink it, or enlarge the workspace or its `regionContainedIn`",
            f"{called(program, item)} is {size}" if size else "",
        )
        if checks_of_object and size and outgrows(node, reaches[region]):
            _warn_of_size(program, item, size, "the workspace" if container is None else "its container")
        checks += checks_of_object
    return checks


def _required(
    node: Node,
    label: str,
    place: tuple[Span | None, str | None],
    never: str,
    help: str,
    note: str = "",
) -> list[NodeCheck]:
    """The check of a built-in requirement: none where it always holds; an error, ``never``, where it never does."""
    span, filename = place
    if not node.is_constant:
        return [NodeCheck(node, label, span, BUILT_IN, cost=20, filename=filename, note=note)]
    if not node.value:
        raise InvalidScenarioError(never, span=span, filename=filename, help=help)
    return []


def _warn_of_size(program: Program, item: Object, size: str, container: str) -> None:
    span, filename = _place(program, item)
    warn(
        f"{called(program, item)} is {size}, larger than {container}",
        span=span,
        filename=filename,
        help="the unit of length is the metre; `MeshShape.fromFile(path, unit='cm')` reads a mesh in centimetres",
    )


def _visibility(program: Program, ego: Object | None, *, mode_2d: bool) -> list[NodeCheck]:
    """Return the checks of visibility: each object that has to be seen by an observer, or must not be (section 10.1)."""

    def seen(observer: object, target: object) -> Node:
        return truth(sees_in_mode(observer, target, program.objects, mode_2d=mode_2d))

    checks: list[NodeCheck] = []
    for item, sighting in program.sightings:
        node = seen(sighting.observer, item)
        name, subject = called(program, item), _subject(program, item)
        whom = called(program, sighting.observer, article="the ")
        if sighting.wanted:
            label, never = f"{name} visible from {whom}", f"{subject} cannot be seen from {whom}"
            node = _if_present(item, node)
        else:
            label, never = f"{name} not visible from {whom}", f"{subject} is always seen from {whom}"
            node = as_node(not node.value) if node.is_constant else connect("not", [node])
        advice = "move one of the two, or what stands between them"
        checks += _required(node, label, _place(program, item), never, advice)
    for item in program.objects:
        requirement = item.requireVisible
        if item is ego or (not is_random(requirement) and not requirement):
            continue
        span, filename = _place(program, item)
        if ego is None and is_random(requirement):
            node = _if_present(item, connect("not", [truth(requirement)]))
            label = f"{called(program, item)} visible from the ego"
            checks.append(NodeCheck(node, label, span, BUILT_IN))
            continue
        if ego is None:
            raise InvalidScenarioError(
                "an object must be visible from the ego, but there is no ego",
                span=span,
                filename=filename,
                help="set `ego = new Object ...`, or write `with requireVisible False`",
            )
        node = seen(ego, item)
        if is_random(requirement):
            node = connect("or", [connect("not", [truth(requirement)]), node])
        node = _if_present(item, node)
        checks += _required(
            node,
            f"{called(program, item)} visible from the ego",
            (span, filename),
            f"{_subject(program, item)} cannot be seen from the ego",
            "move it into view, or write `with requireVisible False`",
        )
    return checks


def _collisions(program: Program) -> list[Check]:
    """One check of all pairs that may collide; pairs of fixed objects are settled here."""
    objects = program.objects
    nodes = [_object_nodes(program, item) for item in objects]
    never = np.array([_is_true(item.allow_collisions) for item in nodes], dtype=np.bool_)
    is_fixed = np.array([all(node.is_constant for node in item.all) for item in nodes], dtype=np.bool_)
    first, second = np.triu_indices(len(objects), 1)
    may_collide = ~(never[first] | never[second])
    if (assemblies := [item.__dict__.get("_assembly") for item in objects]).count(None) < len(objects):
        # The parts of one thing touch each other at their joints.
        owners = np.array([-1 if owner is None else id(owner) for owner in assemblies])
        may_collide &= (owners[first] != owners[second]) | (owners[first] == -1)
    is_settled = is_fixed[first] & is_fixed[second]
    _check_fixed(program, nodes, np.stack([first, second], axis=1)[may_collide & is_settled])
    pairs = np.stack([first, second], axis=1)[may_collide & ~is_settled]
    if not len(pairs):
        return []
    shapes = [nodes[index].shape for index in distinct(pairs).tolist()]
    recall(shape.value.mesh for shape in shapes if shape.is_constant)
    return [CollisionCheck(nodes, pairs)]


def _if_present(item: object, condition: Node) -> Node:
    """Return a condition that applies to an object only if it is present."""
    return condition if is_always_present(item) else connect("or", [as_node(absent(item)), condition])


def _is_true(node: Node) -> bool:
    return node.is_constant and bool(node.value)


def _object_nodes(program: Program, item: Object) -> ObjectNodes:
    span, _ = _place(program, item)
    name = called(program, item)
    label = name if span is None else f"{name} (line {span.line})"
    values = (*body_operands(item), item.allowCollisions)
    position, orientation, size, shape, allowed = (as_node(value) for value in values)
    if not is_always_present(item):
        allowed = _if_present(item, truth(item.allowCollisions))
    return ObjectNodes(position, orientation, size, shape, allowed, label, span)


def _check_fixed(program: Program, nodes: Sequence[ObjectNodes], pairs: NDArray[np.intp]) -> None:
    """Refuse a program in which two fixed objects collide."""
    if not len(pairs):
        return
    members = distinct(pairs)
    objects = [nodes[member] for member in members.tolist()]
    batch = fixed_batch(node for item in objects for node in item.all)
    bodies = [item.body(batch) for item in objects]
    pair_numbers = np.searchsorted(members, pairs)
    if collide(bodies, pair_numbers, lanes=1).free[0]:
        return
    meetings = collide(bodies, pair_numbers, lanes=1, exhaustive=True).pairs
    assert meetings is not None
    bad = pairs[meetings[0]]
    # The first in the program: of the earliest second object, the earliest first one.
    first, second = bad[np.lexsort((bad[:, 0], bad[:, 1]))[0]].tolist()
    one, other = program.objects[first], program.objects[second]
    span, filename = _place(program, other)
    place, _ = _place(program, one)
    where = f" on line {place.line}" if place is not None else ""
    raise InvalidScenarioError(
        f"{_subject(program, other)} always collides with {called(program, one, article='the ')}{where}",
        span=span,
        filename=filename,
        help="move one of the two, or write `with allowCollisions True`",
    )


def _requirements(program: Program) -> list[Check]:
    checks: list[Check] = []
    for position, item in enumerate(program.requirements, start=BUILT_IN + 1):
        node = item.condition
        if node.is_constant and node.value:
            continue
        dear = looks(node)
        checks.append(
            NodeCheck(
                node,
                item.label,
                item.span,
                position,
                item.probability,
                cost=_SIMULATION if item.is_simulated else 60 if dear else 2,
                separate=dear or item.is_simulated,
                filename=item.filename,
            )
        )
    return checks


def _subject(program: Program, item: object) -> str:
    """Return an instance as the subject of a message at its own place."""
    return called(program, item, article="this ")
