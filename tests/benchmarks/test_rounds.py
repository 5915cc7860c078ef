"""The benchmark of rounds drives the engine from within: what it calls is there."""

import scenic
from benchmarks.rounds import boxes, milliseconds


def test_a_round_of_any_size_can_be_measured() -> None:
    engine = scenic.scenarioFromString(boxes(3, 20.0))._sampler.engine
    before = engine.candidates
    for lanes in (4, 16):
        assert milliseconds(engine, lanes, 1) > 0
        assert (engine.candidates - before) % lanes == 0
        before = engine.candidates
