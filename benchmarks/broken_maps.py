"""Broken variants of road maps: ``python -m benchmarks.broken_maps town.xodr ... [--variants 300] [--seed 1] [--show]``.

Each variant has one thing wrong: an attribute that is missing, no number, NaN, huge or negative, an element that is missing, empty
or there twice, or a reference to what does not exist. Counted are the variants that raise anything but `MapError`, those that take
longer than ten seconds and ten times what the map itself takes, and how many diagnostics the others give: none, one (or one
error), or more. ``--show`` prints what was changed where there was none.
"""

import argparse
import copy
import random
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from scenic.domains.driving.loading import MapOptions, network_of
from scenic.formats.opendrive.xml_tree import MapError

UNCACHED = MapOptions(useCache=False, writeCache=False)
VALUES = ("nan", "inf", "1e300", "-1", "", "west", "999999")


def variants(text: str, count: int, seed: int) -> Iterator[tuple[str, str]]:
    """Broken variants of the text of a map, each with what was done."""
    root = ElementTree.fromstring(text)
    draw = random.Random(seed)
    for _ in range(count):
        broken = copy.deepcopy(root)
        done = _break(broken, draw)
        yield ElementTree.tostring(broken, encoding="unicode"), done


def _break(root: Any, draw: random.Random) -> str:
    parents = {child: parent for parent in root.iter() for child in parent}
    # Every kind of element is as likely, however often it is there.
    tag = draw.choice(sorted({item.tag for item in parents}))
    item = draw.choice([item for item in parents if item.tag == tag])
    way = draw.choice(("value", "value", "value", "drop attribute", "drop", "repeat", "empty"))
    if way in ("value", "drop attribute") and item.attrib:
        name = draw.choice(sorted(item.attrib))
        old = item.attrib.pop(name)
        if way == "drop attribute":
            return f"<{tag}> without {name}={old!r}"
        item.set(name, draw.choice(VALUES))
        return f"<{tag}> {name}={item.get(name)!r} instead of {old!r}"
    parent = parents[item]
    if way == "repeat":
        parent.insert(list(parent).index(item), copy.deepcopy(item))
        return f"<{tag}> {item.attrib} twice"
    if way == "empty" and len(item):
        for child in list(item):
            item.remove(child)
        return f"<{tag}> {item.attrib} without content"
    parent.remove(item)
    return f"no <{tag}> {item.attrib}"


def judged(text: str) -> tuple[str, int]:
    """The outcome of loading a variant, ``"error"``, ``"network"`` or a traceback, and the number of diagnostics."""
    try:
        network = network_of.__wrapped__(text.encode(), "broken.xodr", UNCACHED)
        _ = network.drivableRegion, network.walkableRegion, network.curbRegion, network.shoulderRegion
        for move in (move for lane in network.lanes for move in lane.maneuvers):
            _ = move.type, move.conflictingManeuvers
    except MapError:
        return "error", 1
    except Exception:  # noqa: BLE001 - what is looked for
        return traceback.format_exc(limit=-4), 0
    return "network", len(network.problems)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("maps", nargs="+", type=Path)
    parser.add_argument("--variants", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", action="store_true")
    given = parser.parse_args()
    for path in given.maps:
        text = path.read_text(encoding="utf-8")
        begun = time.process_time()
        _, before = judged(text)
        usual = time.process_time() - begun
        found: Counter[str] = Counter()
        slowest = 0.0
        for broken, done in variants(text, given.variants, given.seed):
            begun = time.process_time()
            outcome, diagnostics = judged(broken)
            taken = time.process_time() - begun
            slowest = max(slowest, taken)
            if outcome not in ("error", "network"):
                found["traceback"] += 1
                print(f"  {done}\n{outcome}", flush=True)
                continue
            found["slow"] += taken > max(10.0, 10 * usual)
            more = diagnostics - before if outcome == "network" else 1
            found["none" if more < 1 else "one" if more == 1 else "more"] += 1
            if given.show and more != 1:
                print(f"  {more}: {done}")
        counts = ", ".join(f"{name} {found[name]}" for name in ("traceback", "slow", "none", "one", "more"))
        print(f"{path.name}: {counts}; slowest {slowest:.2f} s, the map {usual:.2f} s", flush=True)


if __name__ == "__main__":
    main()
