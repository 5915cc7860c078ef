"""The page of each diagnostic code: what is wrong, why, an example with its message, and the repair.

The pages are the files ``SCnnn.md`` beside this module. `explanation` reads one; the tests run all of them.
"""

import os
import re
from importlib import resources
from pathlib import Path
from typing import Final

from scenic.dataclass import dataclass
from scenic.language.diagnostics import CODES, Severity

__all__ = ["Explanation", "explanation", "explanation_file"]


@dataclass(frozen=True, slots=True)
class Explanation:
    """A page in its parts.

    ``text`` is all of it, in Markdown. ``language`` is that of the example and its repair: ``scenic``, or ``toml``,
    ``sh`` or ``text`` where what is wrong is no program. ``reason`` says why the tests do not run an example that is
    a program, ``None`` if they do. ``line``, ``column`` (both from 1), ``message`` and ``help`` are those of the example's
    diagnostic; one without a place has ``None``.
    """

    code: str
    title: str
    text: str
    language: str
    reason: str | None
    example: str
    line: int | None
    column: int | None
    severity: Severity
    message: str
    help: str | None
    repair: str


def explanation_file(code: str) -> str | None:
    """Return the file with the page of ``code``; ``None`` if there is none, or if the package is not a folder."""
    page = resources.files(__name__).joinpath(f"{code}.md")
    return os.fspath(page) if isinstance(page, Path) and page.is_file() else None


def explanation(code: str) -> Explanation:
    """Return the page of ``code``.

    Raises `KeyError` if there is no such code, and `ValueError` if its page is not as pages have to be.
    """
    if code not in CODES:
        raise KeyError(code)
    text = resources.files(__name__).joinpath(f"{code}.md").read_text(encoding="utf-8")
    page = _PAGE.fullmatch(text)
    if page is None or page["code"] != code:
        raise ValueError(f"the page of {code} has not the form of a page")
    return Explanation(
        code,
        page["title"],
        text,
        page["language"],
        page["reason"],
        page["example"],
        int(page["line"]) if page["line"] else None,
        int(page["column"]) if page["column"] else None,
        Severity(page["severity"]),
        page["message"],
        page["help"],
        page["repair"],
    )


_PAGE: Final = re.compile(
    r"\# (?P<code>SC\d{3}): (?P<title>[^\n]+)\n\n"
    r"(?:Not executed: (?P<reason>[^\n]+)\n\n)?"
    r"(?:(?!\#).*\n)+?"
    r"\#\# Example\n\n"
    r"(?:[^`\n].*\n\n)*"
    r"```(?P<language>scenic|toml|sh|text)\n(?P<example>(?:(?!```).*\n)+)```\n\n"
    r"\#\# Message\n\n"
    r"```text\n"
    r"(?:(?P<line>\d+):(?P<column>\d+): )?(?P<severity>error|warning|information)\[(?P=code)\]: (?P<message>[^\n]+)\n"
    r"(?:help: (?P<help>[^\n]+)\n)?"
    r"```\n\n"
    r"\#\# Repair\n\n"
    r"(?:(?!\#|```).*\n)+"
    r"```(?P=language)\n(?P<repair>(?:(?!```).*\n)+)```\n"
)
"""The form of a page."""
