"""Broken maps: whatever is wrong, a network or one error comes out."""

import pytest

from benchmarks.broken_maps import judged, variants
from tests.maps import cross, straight


@pytest.mark.parametrize("text", [cross(), straight(100)], ids=["cross", "straight"])
def test_a_broken_map_gives_a_network_or_an_error(text):
    for broken, done in variants(text, 12, seed=7):
        outcome, _ = judged(broken)
        assert outcome in ("error", "network"), done


def test_a_connection_to_a_lane_that_is_not_there_is_reported():
    text = cross()
    assert judged(text) == ("network", 0)
    assert judged(text.replace('<laneLink from="-1"', '<laneLink from="-7"', 1)) == ("network", 1)
