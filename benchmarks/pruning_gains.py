"""Candidates that analysis saves: ``python -m benchmarks.pruning_gains [--solver] [--candidates N]``.

For each program in ``pruning/``, whose requirements few samples meet: candidates a scene without analysis and with it, and seconds
to load without and with it. With ``--solver``, each box that intervals leave is asked of z3 as well: candidates a scene
without the boxes that it refutes, and the seconds that it takes. Run by hand on a quiet machine; nothing here is a test.
"""

import argparse
import math
import statistics
import time
from dataclasses import dataclass
from pathlib import Path

import scenic
from scenic.analysis.smt import SolverEncoding
from scenic.graph.bounding import over
from scenic.graph.node import Graph
from scenic.narrowing import conditions
from scenic.runtime.scenes.scenario import Scenario

HERE = Path(__file__).parent / "pruning"

RESOURCES = 200_000
"""z3's count for one box, at most."""

BOXES = 1024
"""Largest number of boxes given to the solver, the largest boxes first."""


@dataclass(frozen=True)
class Row:
    """The measurements of one program: candidates a scene, and seconds."""

    name: str
    without: float
    intervals: float
    loading: tuple[float, float]
    refuted: float
    solving: float

    @property
    def solver(self) -> float:
        """Candidates a scene with what the solver refutes removed, too."""
        return self.intervals * (1 - self.refuted)


def acceptance(scenario: Scenario, candidates: int) -> float:
    """The share of candidates that pass, of all components together."""
    return math.prod(part.acceptance for part in scenario.estimates(seed=0, candidates=candidates))


def loaded(path: Path, *, prune: bool) -> tuple[Scenario, float]:
    """The scenario, and the median of the seconds that loading takes."""
    times = []
    for _ in range(3):
        begun = time.perf_counter()
        scenario = scenic.load(path, prune=prune)
        times.append(time.perf_counter() - begun)
    return scenario, statistics.median(times)


def refuted(scenario: Scenario) -> float:
    """The share of the volume that is left of which z3 shows that it holds no scene."""
    import z3

    graph = scenario.outline.graph
    facts = [fact for fact in conditions(scenario.outline) if not fact.node.is_constant]
    share = 1.0
    for part, joined in zip(scenario.domain.parts, scenario.domain.joined_axes(), strict=True):
        if not len(joined) and len(scenario.domain.parts) > 1:
            continue
        axes = set(joined.tolist())
        mine = [
            fact
            for fact in facts
            if len(scenario.domain.parts) == 1
            or axes & {graph.axes[node] for node in Graph([fact.node]).axes}
        ]
        if not mine:
            continue
        encoding = SolverEncoding([fact.node for fact in mine])
        solver = z3.Solver(ctx=encoding.terms.context)
        solver.set("rlimit", RESOURCES)
        solver.add(*encoding.terms.definitions, *(term for term, _ in encoding.supports))
        solver.add(*(encoding.truth(fact.node) for fact in mine))
        bounds = over([fact.node for fact in mine], graph.axes, part.lower, part.upper)
        volumes = (part.upper - part.lower).prod(axis=1)
        loss_count = 0.0
        for box in volumes.argsort()[::-1][:BOXES].tolist():
            solver.push()
            for node, known in bounds.items():
                term = encoding.term(node)
                if known is None or node.is_constant or known.lower.ndim != 1 or not z3.is_real(term):
                    continue
                row = box if len(known.lower) > 1 else 0
                low, high = float(known.lower[row]), float(known.upper[row])
                if math.isfinite(low):
                    solver.add(term >= encoding.terms.real(low))
                if math.isfinite(high):
                    solver.add(term <= encoding.terms.real(high))
            if solver.check() == z3.unsat:
                loss_count += float(volumes[box])
            solver.pop()
        share *= 1 - loss_count / float(volumes.sum())
    return 1 - share


def row(path: Path, candidates: int, *, solver: bool) -> Row:
    """Measure a program."""
    scenario, narrowed = loaded(path, prune=True)
    _, plain = loaded(path, prune=False)
    passed = acceptance(scenario, candidates)
    begun = time.perf_counter()
    lost = refuted(scenario) if solver else 0.0
    spent = time.perf_counter() - begun
    whole = 1 / (passed * scenario.domain.volume) if passed else math.inf
    return Row(path.stem, whole, 1 / passed if passed else math.inf, (plain, narrowed), lost, spent)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--solver", action="store_true", help="ask z3 about the boxes that are left, too")
    parser.add_argument("--candidates", type=int, default=20_000, help="of each component, for estimates")
    arguments = parser.parse_args()
    scenic.scenarioFromString("ego = new Object\n").sample(1, seed=0)
    rows = []
    print(
        f"{'program':20}{'without':>12}{'intervals':>11}{'and z3':>9}{'load without':>14}{'with':>7}{'z3':>8}"
    )
    for path in sorted(HERE.glob("*.scenic")):
        found = row(path, arguments.candidates, solver=arguments.solver)
        rows.append(found)
        shown = f"{found.solver:9.4g}{found.loading[0]:13.3f}s{found.loading[1]:6.3f}s{found.solving:7.2f}s"
        print(f"{found.name:20}{found.without:12.4g}{found.intervals:11.4g}{shown}", flush=True)
    gains = [found.without / found.intervals for found in rows]
    print(f"median gain by intervals: {statistics.median(gains):.4g} times fewer candidates")
    if arguments.solver:
        helped = [found.name for found in rows if found.refuted > 0.1]
        print(f"z3 refutes more than a tenth of what is left in {len(helped)} programs: {', '.join(helped)}")
    print(f"longest load: {max(found.loading[1] for found in rows):.2f} s")


if __name__ == "__main__":
    main()
