"""Mistakes that users make, as the benchmark plants them: nearly all are found on their line, and nothing else is accused."""

from benchmarks.mistakes import examine, mistakes


def test_mistakes_are_found_on_their_lines() -> None:
    planted = list(mistakes())
    assert len(planted) > 400
    outcomes = list(examine(planted))
    wrong = [
        f"{each.mistake.theme} {each.mistake.number}" for each in outcomes if each.elsewhere or each.accused
    ]
    assert not wrong
    silent = [f"{each.mistake.theme} {each.mistake.number}" for each in outcomes if not each.found]
    assert len(silent) <= 0.04 * len(planted), silent
