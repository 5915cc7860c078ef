"""From an outline to a sampler of the part of the cube that the requirements allow: finite values first, then intervals."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.contraction import Pruning, independent
from scenic.analysis.facts import Fact
from scenic.analysis.finite.variables import variables_of
from scenic.analysis.screening import seldom_met
from scenic.graph.domain import Domain
from scenic.graph.finite import Finite
from scenic.graph.node import Node
from scenic.narrowing_store import contract_once
from scenic.runtime.regions.unturned import unturned
from scenic.runtime.sampling.check_planning import Outline
from scenic.runtime.sampling.checks import NodeCheck
from scenic.runtime.scenes.sampler import Sampler

if TYPE_CHECKING:
    from scenic.analysis.finite.deciding import Decision

__all__ = ["conditions", "decision_of", "prepared_sampler"]

BETTER: Final = 0.5
"""Boxes of discrete and continuous values together are sampled if they leave less than this share of what decided values leave."""


def conditions(outlined: Outline) -> list[Fact]:
    """Return the hard requirements of an outline as analysis reads them: the program's, then containment and visibility."""
    return [
        *(
            Fact(item.condition, item.label, item.span, False, item.filename)
            for item in outlined.requirements
        ),
        *(Fact(item.node, item.label, item.span, True, item.filename) for item in outlined.built_in),
    ]


def prepared_sampler(outlined: Outline, *, prune: bool) -> Sampler:
    """Return a sampler that is ready; with ``prune``, of the part of the cube that the requirements allow."""
    sampler = Sampler(outlined)
    sampler.prepare()
    if not prune:
        return sampler
    decision = _decided(sampler, sampler.engine.met) if variables_of(sampler.plan.graph) else None
    if decision is not None and decision.impossible:
        checks = [sampler.plan.checks[number] for number in decision.impossible]
        return Sampler(outlined, impossible=tuple(dict.fromkeys(check.label for check in checks)))
    parts = () if decision is None else decision.parts
    pruning = _narrowed(outlined, sampler.met(), _settled(sampler, decision))
    domain = pruning.domain.with_finite(parts)
    apart = _apart(pruning.domain, parts)
    if pruning.domain.with_finite(apart).volume < BETTER * domain.volume:
        pruning = _narrowed(outlined, sampler.met(), ())
        domain = pruning.domain.with_finite(apart)
    if domain.is_whole and not pruning.impossible:
        return sampler
    labels = tuple(dict.fromkeys(item.label for item in pruning.impossible))
    sampler = Sampler(outlined, domain, impossible=labels)
    sampler.prepare()
    return sampler


def _apart(domain: Domain, parts: Sequence[Finite]) -> tuple[Finite, ...]:
    """Return the finite parts none of whose axes are narrowed together with continuous ones."""
    joined = set[int]().union(*(axes.tolist() for axes in domain.joined_axes()))
    return tuple(part for part in parts if joined.isdisjoint(part.axes.tolist()))


def decision_of(outlined: Outline) -> "Decision":
    """The finite part of an outline, whether or not it rejects candidates."""
    return _decided(Sampler(outlined), {}, always=True)


def _decided(sampler: Sampler, met: Mapping[int, NDArray[np.bool_]], *, always: bool = False) -> "Decision":
    from scenic.analysis.finite.deciding import decide  # programs without discrete values do not wait for it

    return decide(sampler.plan, sampler.engine.batch, met, always=always)


def _settled(sampler: Sampler, decision: "Decision | None") -> frozenset[Node]:
    """Return the nodes of the conditions that always hold where draws are made as decided."""
    if decision is None:
        return frozenset()
    checks = (sampler.plan.checks[number] for number in decision.settled)
    return frozenset(check.node for check in checks if isinstance(check, NodeCheck))


def _narrowed(outlined: Outline, met: Mapping[Node, NDArray[np.bool_]], settled: Collection[Node]) -> Pruning:
    """Return the part of the cube that the requirements allow which candidates seldom meet, and those that cannot hold."""
    open_facts = [fact for fact in conditions(outlined) if fact.node not in settled]
    facts = [fact for group in seldom_met(independent(open_facts), met) for fact in group]
    framed = _in_own_frames(facts)
    masks = {
        there.node: met[here.node] for here, there in zip(facts, framed, strict=True) if here.node in met
    }
    return contract_once(outlined.graph, framed, masks)


def _in_own_frames(facts: Sequence[Fact]) -> list[Fact]:
    """Return the facts, those about turned rectangles said in the frames of these, where bounds show more."""
    seen = ((fact, unturned(fact.node)) for fact in facts)
    return [fact if node is None else replace(fact, node=node) for fact, node in seen]
