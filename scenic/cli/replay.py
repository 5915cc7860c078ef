"""``scenic replay``: makes a run that was kept again, and tells whether it is the same."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from scenic.cli.options import simulator_option
from scenic.cli.output import CLEAN
from scenic.cli.running import NOT_ALL

__all__ = ["replay"]


@click.command()
@click.argument("path", metavar="RUN", type=click.Path(path_type=Path))
@click.argument("number", metavar="[NUMBER]", type=click.IntRange(min=0), required=False)
@click.option(
    "--program",
    metavar="FILE",
    type=click.Path(),
    help="The program, where it is no longer in its place.  [default: the one that the run names]",
)
@simulator_option
@click.option(
    "--view", metavar="PAGE.html", type=click.Path(path_type=Path), help="Make a page that plays it."
)
@click.option("--show-records", is_flag=True, help="Print what the simulation records.")
def replay(
    path: Path,
    number: int | None,
    program: str | None,
    simulator: str | None,
    view: Path | None,
    show_records: bool,
) -> int:
    """Make a run again that `falsify -o` or `simulate -o` has kept, and compare it with what was kept.

    RUN is the folder of a search or of one of its counterexamples, a folder of simulations, or the file of one. NUMBER chooses
    a run of a folder: by default the worst of a search, the first of simulations.

    Exit codes: 0 the run is the same, bit by bit, 1 the program has errors, 2 wrong usage, 3 it differs.
    """
    from scenic.falsification.replaying import kept_run
    from scenic.falsification.replaying import replay as made_again
    from scenic.formats.files import write
    from scenic.pipeline import load

    run = kept_run(path, number)
    scenario = load(Path(program or run.origin["file"]), **run.origin["options"])
    found = made_again(run, scenario, simulator, shown=view is not None)
    _show(run.number, found.about)
    if show_records:
        for name, value in found.about.get("records", {}).items():
            print(f"  record {name} = {value}")
    if view is not None and found.page is not None:
        write(view, found.page.encode())
    if not found.departures:
        print("the same as kept, bit by bit")
        return CLEAN
    for words in found.departures:
        print(f"differs: {words}")
    return NOT_ALL


def _show(number: int, about: Mapping[str, Any]) -> None:
    """Print what came of the run."""
    requirements = about.get("requirements") or {}
    if isinstance(requirements, list):
        requirements = {item["label"]: item for item in requirements}
    outcome = about.get("status") or about.get("reason") or "nothing"
    steps = f", {about['steps']} steps" if "steps" in about else ""
    print(f"run {number}: {outcome}{steps}")
    if about.get("values"):
        print(f"  value {min(map(float, about['values'])):.6g}")
    for label, item in requirements.items():
        verdict = "not evaluated" if item["verdict"] is None else item["verdict"].lower().replace("_", " ")
        by = f", robustness {item['robustness']:.4g}" if isinstance(item["robustness"], float) else ""
        print(f"  {label}: {verdict}{by}")
    if about.get("error"):
        print(f"  {about['error']}")
