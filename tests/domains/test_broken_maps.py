"""Broken maps: whatever is wrong, a network or one error comes out, and what breaks the standard is told once, in its place."""

from xml.etree import ElementTree

import pytest

from benchmarks.broken_maps import faults_beside, judged, variants
from tests.maps import cross, straight


@pytest.mark.parametrize("text", [cross(), straight(100)], ids=["cross", "straight"])
def test_a_broken_map_gives_a_network_or_an_error(text):
    for variant in variants(text, 25, seed=7):
        outcome, lines = judged(variant.text)
        assert outcome in ("error", "network"), variant.done
        if faults_beside(ElementTree.fromstring(variant.text)):
            assert len(lines) == 1, variant.done
            assert set(lines) <= variant.lines, variant.done


STRAIGHT = straight(100)
CROSS = cross()


@pytest.mark.parametrize(
    ("text", "old", "new", "message"),
    [
        (STRAIGHT, '<header revMajor="1" revMinor="4"/>', "", "the map has no <header>"),
        (STRAIGHT, 'revMajor="1"', 'revMajor="nan"', "'revMajor' of <header> of the map is 'nan', not a version number"),
        (STRAIGHT, ' length="100" id', " id", "<road> of road 1 has no 'length'"),
        (STRAIGHT, '<lane id="0" type="none"/>', "", "<center> of road 1 has no <lane>"),
        (STRAIGHT, '<lane id="0" ', '<lane id="7" ', "the middle lane of road 1 has the id 7, not 0"),
        (STRAIGHT, 'type="sidewalk"', 'type="west"', "'type' of <lane> of lane 2 of road 1 is 'west', not one of those"),
        (STRAIGHT, '<laneSection s="0">', '<laneSection s="9">', "begins at s = 9, not 0"),
        (STRAIGHT, '<lane id="2"', '<lane id="5"', "with the ids 1, 5 leave numbers out"),
        (STRAIGHT, 'sOffset="0" a="2" b="0"', 'sOffset="0" a="2" b="nan"', "lane of road 1 is left out: 'b' of <width>"),
        (CROSS, 'junction="9"', 'junction="8"', "junction 8, which a link names, is not there"),
        (CROSS, '<junction id="9"', '<junction id="8"', "junction 9, which 16 links name, is not there"),
        (CROSS, '<connection id="1"', '<connection id="0"', "<connection> 0 of junction 9 has the id of another one"),
        (CROSS, '<successor id="1"/>', '<successor id="west"/>', "is 'west', not a number: dropped"),
        (CROSS, '<successor id="1"/>', "", "lane -1 of connecting road 100 leads nowhere"),
        (CROSS, '<laneLink from="-1"', '<laneLink from="-7"', "lane -7 at the end of road 1, which a link names"),
    ],
)  # fmt: skip
def test_a_fault_is_told_once(text, old, new, message):
    from scenic.domains.driving.loading import MapOptions, network_of

    assert judged(text) == ("network", ())
    options = MapOptions(useCache=False, writeCache=False)
    (problem,) = network_of.__wrapped__(text.replace(old, new, 1).encode(), "map.xodr", options).problems
    assert message in problem.message


def test_a_reference_line_that_is_torn_is_told_once():
    text = straight(100).replace(
        "<line/></geometry>",
        '<line/></geometry><geometry s="100" x="105" y="0" hdg="0" length="20"><line/></geometry>',
    )
    text = text.replace('length="100" id', 'length="120" id')
    assert judged(text)[0] == "network"
    assert len(judged(text)[1]) == 1


SIGNAL = '<signal id="7" s="58" t="-5" zOffset="4" orientation="+" dynamic="yes" type="1000001" subtype="-1">{}</signal>'
CROSSWALK = '<objects><object id="3" type="crosswalk" s="40" t="0" zOffset="0">{}</object></objects>'


@pytest.mark.parametrize(
    ("text", "code", "message"),
    [
        (cross(signal=SIGNAL.format('<validity fromLane="-9" toLane="-7"/>')), "SC621", "signal 7 of road 1 is valid for lanes -9 to -7, which"),
        (cross(signal=SIGNAL.format('<validity fromLane="3" toLane="3"/>')), "SC621", "signal 7 of road 1 is valid for lane 3, which"),
        (cross(signal=SIGNAL.format('<dependency id="99" type="x"/>')), "SC623", "signal 7 of road 1 names signal 99, which is not there"),
        (cross(signal=SIGNAL.format('<reference elementType="signal" elementId="98"/>')), "SC623", "signal 7 of road 1 refers to signal 98, which"),
        (cross(signal=SIGNAL.format("") + '<signalReference id="55" s="3" t="0" orientation="+"/>'), "SC623", "road 1 refers to signal 55"),
        (CROSS.replace("<junction", '<controller id="1"><control signalId="77" type="0"/></controller><junction'), "SC623", "controller 1 names signal 77"),
        (CROSS.replace("</junction>", '<controller id="5" type="0"/></junction>'), "SC623", "junction 9 names controller 5"),
        (CROSS.replace("<planView>", '<type s="0" type="town"><speed max="fast"/></type><planView>', 1), "SC621", "'max' of <speed> of road 1 is 'fast', not a number"),
        (CROSS.replace("<planView>", '<type s="0" type="town"><speed max="9" unit="knots"/></type><planView>', 1), "SC621", "'unit' of <speed> of road 1 is 'knots'"),
        (straight(100, rest=CROSSWALK.format("")), "SC621", "crosswalk 3 is left out: it has no outline with three corners"),
        (straight(100, rest=CROSSWALK.format('<outline><cornerLocal u="1" v="x"/></outline>')), "SC621", "crosswalk 3 is left out: 'v' of <cornerLocal> is 'x'"),
    ],
)  # fmt: skip
def test_names_that_mean_nothing_are_told_once(text: str, code: str, message: str) -> None:
    from scenic.domains.driving.loading import MapOptions, network_of

    options = MapOptions(useCache=False, writeCache=False)
    (problem,) = network_of.__wrapped__(text.encode(), "map.xodr", options).problems
    assert problem.code == code
    assert message in problem.message
    assert problem.span is not None


def test_controllers_and_signals_that_are_there_are_fine() -> None:
    text = cross(signal=SIGNAL.format('<validity fromLane="-1" toLane="-1"/><dependency id="7"/>'))
    text = text.replace("<junction", '<controller id="1"><control signalId="7"/></controller><junction')
    assert judged(text.replace("</junction>", '<controller id="1"/></junction>')) == ("network", ())
