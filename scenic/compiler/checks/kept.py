"""What was said of parts of a program, kept for the check of its next version.

The top level is divided into stretches (`scenic.compiler.scopes`), which stay the same objects as long as nothing in them
changes. What a rule says of a stretch depends on its nodes, on what the names that it reads mean, on what these need in
turn, and on facts about the whole program that it asks for. If all of that is as before, so is what is said.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from scenic.compiler.scopes import Binding, Stretch
from scenic.language.diagnostics import Diagnostic

__all__ = ["Kept", "Said", "changed_names"]


@dataclass(frozen=True, slots=True)
class Said:
    """What was found in one stretch, and the facts about the whole program that were asked for meanwhile."""

    found: tuple[Diagnostic, ...]
    facts: tuple[tuple[str, object], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Kept:
    """What was said of the stretches of one version by each group of rules.

    ``state`` is what every rule may depend on, ``names`` what the names of the module mean.
    """

    state: Sequence[object]
    names: Mapping[str, Binding]
    said: Mapping[tuple[str, Stretch], Said]


def changed_names(
    before: Mapping[str, Binding], after: Mapping[str, Binding], stretches: Iterable[Stretch]
) -> frozenset[str]:
    """The names of the module that mean something else than before, or need such names for what they mean."""
    changed = before.keys() ^ after.keys()
    for name, binding in after.items():
        old = before.get(name)
        # The nodes are in no particular order.
        if old is not None and old.sites != binding.sites and {*old.sites} != {*binding.sites}:
            changed.add(name)
    if not changed:
        return frozenset()
    waiting = [item for stretch in stretches for item in stretch.needs.items()]
    grown = True
    while grown:
        met = [name for name, needed in waiting if not needed.isdisjoint(changed)]
        grown = not changed.issuperset(met)
        changed.update(met)
    return frozenset(changed)
