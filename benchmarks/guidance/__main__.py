"""Judges the messages of mistakes by place, cause and repair: ``python -m benchmarks.guidance``."""

import argparse
from collections import Counter

from benchmarks.guidance import Judgement, judge, read

__all__ = ["main"]


def main() -> None:
    """Print the share of right places, causes and repairs of each list, and the mistakes that fall short."""
    parser = argparse.ArgumentParser(
        description="mistakes judged by the place, cause and repair they are given"
    )
    parser.add_argument(
        "lists",
        nargs="*",
        default=["first", "second", "third", "fourth", "fifth", "sixth"],
        help="the lists to judge",
    )
    parser.add_argument("--show", action="store_true", help="print the messages of all mistakes")
    arguments = parser.parse_args()
    for name in arguments.lists:
        judgements = list(judge(list(read(name))))
        for judgement in judgements:
            right = judgement.place and judgement.cause and judgement.repair in ("none", "meant")
            if arguments.show or not right or judgement.accused:
                _report(judgement)
        repairs = Counter(each.repair for each in judgements)
        print(
            f"{name}: {len(judgements)} mistakes; "
            f"place {sum(each.place for each in judgements)}, cause {sum(each.cause for each in judgements)}; "
            f"repairs: {repairs['meant']} as meant, {repairs['other']} other, {repairs['wrong']} wrong; "
            f"{sum(bool(each.accused) for each in judgements)} right programs accused"
        )


def _report(judgement: Judgement) -> None:
    mistake = judgement.mistake
    lines = mistake.text.splitlines()
    print(f"{mistake.number}: {'  '.join(lines[line - 1].strip() for line in sorted(mistake.lines))}")
    verdict = [
        f"place {'right' if judgement.place else 'WRONG'}",
        f"cause {'right' if judgement.cause else 'WRONG'} (/{mistake.cause.pattern}/)",
        f"repair {judgement.repair}",
    ]
    print("    " + ", ".join(verdict))
    for title, found in (("", judgement.diagnostics), ("meant: ", judgement.accused)):
        for each in found:
            line = 0 if each.span is None else each.span.line
            print(f"    {title}{line}: {each.code} {each.message} ({each.help or ''})")
    if judgement.repair in ("other", "wrong"):
        print("    repaired: " + judgement.repaired.replace("\n", "\n              ").rstrip())


if __name__ == "__main__":
    main()
