"""Numbers of diagnostics of each code."""

from collections import Counter

from scenic.cli.render.report import Report
from scenic.language.diagnostics import CODES

__all__ = ["render_statistics"]


def render_statistics(report: Report) -> str:
    """Write a line for each code, the most frequent ones first: its number of diagnostics, the code, ``[*]`` if ``--fix`` repairs them, its title."""
    counts = Counter(item.code for item in report.diagnostics)
    repaired = {item.code for item in report.diagnostics if item.fix is not None and item.fix.certain}
    width = len(str(max(counts.values(), default=0)))
    return "".join(
        f"{count:{width}}  {code}  {'[*]' if code in repaired else '   '}  {CODES[code]}\n"
        for code, count in sorted(counts.items(), key=lambda item: (-item[1], item[0]))
    )
