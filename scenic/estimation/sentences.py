"""An estimate in words, for readers who know no statistics: no probability without its interval."""

import math
from statistics import NormalDist
from typing import Final

from scenic.estimation.branching import Rare
from scenic.estimation.estimate import Estimate, Tally
from scenic.statistics.confidence_intervals import Interval
from scenic.statistics.weighting import LEAST_EFFECTIVE

__all__ = ["comparison_words", "counted", "described", "headline", "method_words", "notes", "percent"]

_FEW: Final = 30
"""Runs below which there are too few to say much."""

_WORTH: Final = 3
"""Factor by which plain runs have to be more for that to be said."""

_COMMON: Final = 0.03
"""Probability from which failures are not rare."""

_WIDE: Final = 0.1
"""Half the width of an interval that is called wide."""


def counted(number: int, thing: str) -> str:
    """A number of things."""
    return f"{number:,} {thing}{'' if number == 1 else 's'}"


def percent(confidence: float) -> str:
    """Return a confidence in percent."""
    return f"{100 * confidence:.4g}%"


def described(probability: float, interval: Interval, confidence: float) -> str:
    """Return a probability with its interval."""
    words = f"{percent(confidence)} interval {interval}"
    return f"unknown ({words})" if math.isnan(probability) else f"{probability:.3g} ({words})"


def method_words(estimate: Estimate) -> str:
    """Return the way in which the interval is made."""
    if estimate.rare is not None and estimate.rare.is_known:
        return f"from the spread of {len(estimate.rare.logarithms)} repetitions (t interval of the logarithm; approximate)"
    if estimate.weighted is not None:
        return "of a weighted share (Fay and Feuer)"
    if not estimate.at_any_time:
        total = estimate.total
        is_one_sided = total.violations in (0, total.runs) and not total.unknown
        bound = "; one end is sure, the other a one-sided bound" if is_one_sided else ""
        return f"for a number of runs that was fixed in advance (Clopper and Pearson{bound})"
    return "which holds however often one looks (confidence sequence)"


def headline(estimate: Estimate) -> list[str]:
    """The result in a few lines."""
    outcome_count = sum(row["values"] is not None for row in estimate.rows)
    violations = counted(estimate.violations, "counterexample")
    result = described(estimate.probability, estimate.interval, estimate.confidence)
    lines = [
        f"{counted(len(estimate.rows), 'run')}, {outcome_count:,} with a value, {violations}",
        f"probability of a counterexample {result}",
    ]
    test = estimate.asked.test
    if test is not None:
        lines.append(_answer(estimate))
    return lines


def _answer(estimate: Estimate) -> str:
    test = estimate.asked.test
    assert test is not None
    if estimate.answer is None:
        return f"not decided: whether the probability is at most {test.bound:g} needs more runs"
    if estimate.answer:
        return (
            f"at most {test.bound:g}: if the probability were {test.bound:g} or more, this answer would come in at most"
            f" {percent(1 - test.confidence)} of such tests"
        )
    return (
        f"not shown to be at most {test.bound:g}: if the probability were {test.good:g} or less, this answer would come in at"
        f" most {percent(1 - test.power)} of such tests"
    )


def notes(estimate: Estimate) -> list[str]:
    """List remarks that a reader has to know about the result."""
    special = _about_rare(estimate.rare, estimate) if estimate.rare is not None else _about_weights(estimate)
    is_special = estimate.weighted is not None or (estimate.rare is not None and estimate.rare.is_known)
    plain = [] if is_special else [*_about_ending(estimate), *_about_counts(estimate)]
    return [*special, *plain, *_about_requirements(estimate), *_about_chance(estimate)]


def _about_rare(rare: Rare, estimate: Estimate) -> list[str]:
    """Return remarks on a splitting."""
    if rare.is_flat:
        return [
            (
                "The values do not say how near a run comes to a failure: too many of them are equal, or plus or minus infinity, so that"
                " there is nothing to follow. The runs that no move has made count as plain ones. A requirement about a distance or a speed"
                " says more than one that only holds or fails."
            )
        ]
    if not rare.is_known:
        budget = max(2 * len(estimate.rows), 40 * rare.pilot.runs)
        return [
            (
                f"The budget of {estimate.asked.runs:,} runs ended before two repetitions were finished, so the interval is that of the"
                f" {counted(estimate.total.runs, 'run')} that no move has made. Give more: about --budget {budget}."
            )
        ]
    repetition_count = len(rare.logarithms)
    levels = max(len(item.levels) for item in rare.repetitions) + 1
    words = [
        (
            f"The probability comes from {repetition_count} repetitions in {counted(levels, 'level')}, and the interval from their spread: it"
            " is not exact, as that of a number of plain runs is."
        )
    ]
    if rare.probability > _COMMON:
        words.append("Failures are not rare here: plain runs (-n) give an exact interval.")
    plain = _plain_runs(estimate)
    if plain > _WORTH * len(estimate.rows):
        words.append(f"Plain runs would have to be about {_rounded(plain):,} for an interval as narrow.")
    if repetition_count < len(rare.repetitions) or rare.is_out_of_budget:
        words.append(
            f"The budget of {estimate.asked.runs:,} runs ended before the other repetitions were finished."
        )
    if rare.mixes_badly:
        words.append(
            "At some level hardly any move was accepted, or all of the last runs of a repetition descend from a single first one: the"
            " repetitions may agree with one another and yet miss ways to fail. Compare with another seed and a larger budget."
        )
    return words


def _plain_runs(estimate: Estimate) -> float:
    """The number of plain runs whose interval would be as narrow, by the normal approximation."""
    low, high = estimate.interval
    width = math.log(high / low) / 2 if low > 0 else math.inf
    normal = NormalDist().inv_cdf((1 + estimate.confidence) / 2)
    return (normal / width) ** 2 * (1 - estimate.probability) / estimate.probability


def _rounded(number: float) -> int:
    """A number with its first digit alone."""
    power = 10 ** max(0, math.floor(math.log10(number)))
    return int(round(number / power) * power)


def _about_weights(estimate: Estimate) -> list[str]:
    """Return remarks on importance sampling."""
    weights = estimate.weighted
    if weights is None:
        return []
    effective = f"{weights.effective:.0f}"
    if not weights.is_known:
        return [
            (
                f"The counterexamples count as no more than {effective} equal ones, as their weights differ much; {LEAST_EFFECTIVE:.0f} are"
                " needed, so there is no estimate. Make more runs (-n), search longer, or use --rare."
            )
        ]
    return [
        (
            f"The runs were drawn where the search has found counterexamples, and are weighted to make up for that; the counterexamples"
            f" count as {effective} equal ones."
        )
    ]


def comparison_words(estimate: Estimate) -> list[str]:
    """Return the comparison with another program, if there is one."""
    pairs = estimate.comparison
    if pairs is None:
        return []
    difference = described(pairs.difference, pairs.interval(estimate.confidence), estimate.confidence)
    words = f"probability of the first less that of the second {difference}, from {counted(pairs.pairs, 'run')} of both."
    low, high = pairs.interval(estimate.confidence)
    if low > 0 or high < 0:
        return [
            f"{words} So large a difference would come by chance with a probability of at most {pairs.p_value:.2g} (McNemar)."
        ]
    return [
        f"{words} Such a difference may well be chance (p = {pairs.p_value:.2g}, McNemar): they are not shown to differ."
    ]


def _about_ending(estimate: Estimate) -> list[str]:
    question, words = estimate.asked, []
    if not estimate.is_finished:
        because = f": {estimate.stop_reason}" if estimate.stop_reason else ""
        if question.method == "precision":
            words.append(
                f"The precision of {question.precision:g} is not reached{because}. The interval is right, but wider: plus or minus"
                f" {estimate.interval.half_width:.2g}."
            )
        elif question.method == "fixed number":
            words.append(
                f"Only {len(estimate.rows):,} of {question.runs:,} runs are made{because}. The interval allows for that: it is one that"
                " holds whenever one stops."
            )
        else:
            what = "test" if question.method == "bound" else "estimate"
            words.append(f"The {what} has no answer yet{because}.")
    elif question.method == "fixed number" and estimate.at_any_time:
        words.append(
            "More runs were asked for when some had been looked at, so the interval is one that holds however often one looks; it"
            " is a little wider."
        )
    return words


def _about_counts(estimate: Estimate) -> list[str]:
    total, interval = estimate.total, estimate.interval
    confidence = percent(estimate.confidence)
    outcome_count = total.runs - total.unknown
    if outcome_count == 0:
        if estimate.total.rejected:
            reason = f"Scene or simulation was rejected for each of the {counted(total.rejected, 'number')}"
            return [f"{reason}: nothing is known of the probability."]
        return ["No run has an outcome: nothing is known of the probability."]
    words = []
    if total.violations == 0:
        words.append(
            f"No run was a counterexample. That does not show that there is none: with a confidence of {confidence}, fewer than one"
            f" run in {max(1, int(1 / interval.high)):,} is one."
        )
    elif total.violations == outcome_count:
        words.append(
            f"Every run was a counterexample. With a confidence of {confidence}, more than {100 * interval.low:.3g}% of all runs are."
        )
    if outcome_count < _FEW and interval.half_width > _WIDE:
        words.append(
            f"{counted(outcome_count, 'run')} {'is' if outcome_count == 1 else 'are'} too few to say much: the probability may be anything from"
            f" {interval.low:.2g} to {interval.high:.2g}. Make more (-n), or ask for a precision (--precision)."
        )
    if total.unknown:
        words.append(
            f"{counted(total.unknown, 'run')} failed and {'has' if total.unknown == 1 else 'have'} no outcome. The interval allows"
            " for either outcome of each."
        )
    if total.rejected:
        number_count = total.rejected + total.runs
        words.append(
            f"{total.rejected:,} of {number_count:,} numbers gave no run, as scene or simulation was rejected. The probability is that"
            " among the other runs."
        )
    return words


def _about_requirements(estimate: Estimate) -> list[str]:
    words = []
    for tally in estimate.requirements:
        outcome_count = tally.runs - tally.unknown
        if outcome_count == 0:
            continue
        if tally.unseen == outcome_count:
            words.append(
                f"`{tally.label}` was never evaluated: no run came to the part of the program that states it, so that these runs say"
                " nothing about it."
            )
        elif tally.unseen:
            words.append(
                f"`{tally.label}` was not evaluated in {tally.unseen:,} of {counted(outcome_count, 'run')}; these count as runs in which it"
                " held."
            )
        words += _about_verdicts(tally, outcome_count)
    return words


def _about_verdicts(tally: Tally, known: int) -> list[str]:
    """Return remarks on what simulations that end leave open."""
    open_ = tally.presumable + tally.unmet
    longer = "Longer simulations (--time) may tell."
    if open_ == known - tally.unseen and tally.unmet == 0 and open_:
        always = f"`{tally.label}` was never decided for good: in all runs that evaluated it, it held until the simulation ended"
        return [f"{always} (presumably true), which counts as held. {longer}"]
    remarks = []
    if tally.presumable:
        remarks.append(
            f"In {counted(tally.presumable, 'run')} `{tally.label}` held until the simulation ended (presumably true), which counts as"
            " held."
        )
    if tally.unmet:
        remarks.append(
            f"In {counted(tally.unmet, 'run')} `{tally.label}` was not met when the simulation ended (presumably false), which counts"
            f" as violated. {longer}"
        )
    return remarks


def _about_chance(estimate: Estimate) -> list[str]:
    if estimate.is_repeatable is False and estimate.rare is not None:
        words = (
            "The first run, made once more, was another: the simulator or a controller draws random numbers of its own, which moves"
            " cannot follow. The probability and its interval may be wrong: let all random numbers follow from the program's draws."
        )
        return [words]
    if estimate.is_repeatable is False:
        words = (
            "The first run, made once more, was another: the simulator or a controller draws random numbers of its own, which do not"
            " follow from the seed. They are part of the probability, and the interval is right, but these runs cannot be repeated."
        )
        return [words]
    return []
