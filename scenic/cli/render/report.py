"""The input of a renderer: all that there is to say about one run."""

from collections.abc import Sequence
from dataclasses import field

from scenic.cli.render.sources import Sources
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic

__all__ = ["Report"]


@dataclass(frozen=True, slots=True)
class Report:
    """The diagnostics of a run, in order, with the texts that they refer to.

    ``files`` is how many files were checked, ``names`` what they are called, ``fixed`` how many repairs were made in them, ``exit_code`` what the
    command ends with; ``colour`` says whether the output is for a terminal that has colours.
    """

    diagnostics: Sequence[Diagnostic]
    sources: Sources = field(default_factory=Sources)
    files: int = 1
    fixed: int = 0
    exit_code: int = 0
    colour: bool = False
    names: Sequence[str] = ()
