"""Diagnostics of a document, as the editor shows them: the same as ``scenic check``."""

from collections.abc import Callable

from scenic.ide.snapshot import Cancelled, Snapshot
from scenic.language.code_selection import Rules
from scenic.language.diagnostics import Diagnostic
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

__all__ = ["diagnostics", "found_in"]


def diagnostics(
    text: str, *, filename: str, rules: Rules | None = None, project: Project | None = None
) -> tuple[Diagnostic, ...]:
    """The findings of the static check that the rules leave, in order of place.

    Without a ``project``, nothing is known of the modules that the document imports. Runs none of the program, and never
    raises.
    """
    return found_in(Snapshot(text, filename), rules or Rules(), project)


def found_in(
    snapshot: Snapshot,
    rules: Rules,
    project: Project | None,
    *,
    stamp: object = None,
    go_on: Callable[[], None] = lambda: None,
) -> tuple[Diagnostic, ...]:
    """Return the findings in a snapshot that the rules leave; the snapshot keeps all findings as long as ``stamp`` is the same.

    ``stamp`` stands for the state of all other files. ``go_on`` is called between steps, and may raise
    `Cancelled` to stop.
    """
    go_on()

    def find() -> tuple[Diagnostic, ...]:
        try:
            surroundings_of = None if project is None else surroundings_in(project)
            return snapshot.check(surroundings_of, go_on)
        except Cancelled:
            raise
        except Exception as error:  # noqa: BLE001 - an editor must go on; the fault is shown in the document
            return (
                Diagnostic(
                    "SC999",
                    f"internal error: {type(error).__name__}: {error}",
                    filename=snapshot.filename,
                    help="this is a fault of scenic, not of your program; please report it with the program",
                ),
            )

    diagnostics = snapshot.derived("diagnostics", find, stamp=stamp)
    go_on()
    return rules.apply(diagnostics)
