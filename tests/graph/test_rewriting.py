"""Simpler nodes have the values, kinds and fates of those that they take the place of."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from graph.programs import Triple, constant, make, one_of, sampled, source, uniform
from scenic.graph import construction
from scenic.graph import node as graph
from scenic.graph.kinds import Kind
from scenic.graph.operation import OK
from scenic.graph.operations import TABLE

LANES = 40


X, Y, Z = uniform(-3.0, 3.0), uniform(-7.0, 7.0), uniform(0.5, 1.5)
NUMBERS = [
    *(
        X,
        Y,
        make("normalize angle", Y),
        make("negative", X),
        source(Kind.INTEGER, [3]),
        source(Kind.BOOLEAN, [True]),
    ),
    *(constant(value) for value in (0, 0.0, -0.0, 1, 1.0, -1.0, 2.5, True, False)),
]
VECTORS = [
    *(
        make("vector", X, Y, Z),
        make("vector", X, 0.0, 0.0),
        make("vector", source(Kind.INTEGER, [2]), X, True),
    ),
    *(constant(Triple(row)) for row in ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, -2.0, 3.0))),
]
TURNED = make("from euler", X, Z, Y)
ORIENTATIONS = [
    *(TURNED, make("from euler", X, 0.0, 0.0), make("from euler", Y, 0.0, 0.0), make("inverse", TURNED)),
    make("inverse", make("from euler", Y, 0.0, 0.0)),
    make("compose", make("from euler", X, 0.0, 0.0), make("from euler", Y, 0.0, 0.0)),
    make("compose", TURNED, make("from euler", Y, 0.0, 0.0)),
    *(
        graph.constant(row, Kind.ORIENTATION, row)
        for row in ((0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, -1.0), (0.0, 1e-9, 0.0, 1.0), (0.6, 0.0, 0.0, 0.8))
    ),
]
ANGLES = [X, Y, constant(0.0), constant(0), constant(-0.0), constant(0.7), source(Kind.INTEGER, [2])]
CHOICES = [constant(value) for value in (1.0, 2.5, -1.0)]

OBJECTS = [
    one_of(1, 2.5),
    *(graph.constant(value, Kind.OTHER, value) for value in (0, 1, 1.0, True, "1", [0])),
]
"""Numbers of mixed kinds among them, of which Python may make anything."""
PAIRS = list(itertools.product([*NUMBERS, *VECTORS, *ORIENTATIONS, *OBJECTS], repeat=2))

OPERANDS = {
    "add": PAIRS,
    "multiply": PAIRS,
    "divide": PAIRS,
    "normalize angle": [
        (angle,)
        for angle in (
            *(*NUMBERS, *OBJECTS, make("add", X, 0.2), make("multiply", X, 1.1)),
            *(make("subtract", make("absolute", X), end) for end in (0.0, 3.5, 3.2)),
            *(make("subtract", end, make("absolute", X)) for end in (0.0, 3.5, 3.2)),
        )
    ],
    "component": [(vector,) for vector in VECTORS],
    "from euler": list(itertools.product(ANGLES, repeat=3)),
    "compose": list(itertools.product(ORIENTATIONS, repeat=2)),
    "inverse": [(turn,) for turn in ORIENTATIONS],
    "rotate": list(itertools.product(ORIENTATIONS, VECTORS)),
    "euler": [(turn,) for turn in ORIENTATIONS],
    "select": [(one_of(5, 6, 7).operands[0], *CHOICES), (one_of(5, 6, 7).operands[0], X, Y, X)],
}
OPERANDS["subtract"] = OPERANDS["add"]
PAYLOADS = {"component": range(3), "euler": range(3)}


def test_every_rule_is_looked_at() -> None:
    assert {name for name, operation in TABLE.items() if operation.rewrite is not None} == OPERANDS.keys()


@pytest.mark.parametrize("name", sorted(OPERANDS))
def test_simpler_nodes_have_the_same_values(name: str) -> None:
    plain = replace(TABLE[name], rewrite=None)
    pairs = []
    for operands in OPERANDS[name]:
        for payload in PAYLOADS.get(name, [None]):
            simpler = TABLE[name].rewrite(operands, payload)
            if simpler is not None:
                pairs.append((simpler, construction.make_node(plain, operands, payload)))
    assert len(pairs) >= 2 or name == "select"
    batch = sampled([node for pair in pairs for node in pair], LANES)
    for simpler, other in pairs:
        assert simpler.kind is other.kind, (name, simpler, other)
        fates = [
            np.full(LANES, OK) if status is None else status for status in map(batch.status, (simpler, other))
        ]
        np.testing.assert_array_equal(*fates)
        found, expected = (batch.full(node)[fates[0] == OK].astype(float) for node in (simpler, other))
        if simpler.kind is Kind.ORIENTATION:  # a rotation has two quaternions
            expected = expected * np.sign((found * expected).sum(axis=1, keepdims=True))
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)
