"""The table of everything a user waits for."""

import argparse
from pathlib import Path

import pytest

import benchmarks.__main__ as overview
from benchmarks.__main__ import Row, Spent


def test_the_table_compares_medians_over_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    warm = Row(7, 7, 7, 7)  # fills caches of compiled modules, and is not counted
    turns = iter([warm, Row(1, 2, 100, 0.1), Row(9, 9, 900, 0.9), Row(1, 1, 50, 0.2)] * 2)
    monkeypatch.setattr(overview, "ours", lambda path: next(turns))
    monkeypatch.setattr(overview, "theirs", lambda command, path, scenes, turn: Row(4, 8, 400, 2 * turn + 1))
    options = argparse.Namespace(reference="other", scenes=5, turns=3)
    lines = overview.table(options, [Path("a.scenic"), Path("b.scenic")])
    assert lines[2] == "| `a` | 1.00 s | 4.0x | 2.00 s | 4.0x | 100 | 4.0x | 200 ms | 15x |"
    assert lines[-2:] == [
        "| geometric mean | | 4.0x | | 4.0x | | 4.0x | | 15x |",
        "| least | | 4.0x | | 4.0x | | 4.0x | | 15x |",
    ]


def test_the_reference_measures_its_scenes_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = "".join(f'{{"iterations": 1, "seconds": {seconds}}}\n' for seconds in (9, 1, 2))

    def spent(command: list[str]) -> Spent:
        return Spent(2.0, 60, lines if command[-1] == "--time" else "")

    monkeypatch.setattr(overview, "spent", spent)
    assert overview.theirs("other", Path("a.scenic"), 2, 1) == Row(2.0, 2.0, 60, 1.5)
    lines = '{"error": "no scene was found"}\n'
    with pytest.raises(SystemExit, match=r"a.scenic: .*no scene was found"):
        overview.theirs("other", Path("a.scenic"), 2, 1)
