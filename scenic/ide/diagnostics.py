"""What is wrong with a document, as the editor shows it: the same as ``scenic check``."""

from scenic.compiler.check import check_text
from scenic.language.diagnostics import Diagnostic
from scenic.language.selection import Rules
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

__all__ = ["diagnostics"]


def diagnostics(
    text: str, *, filename: str, rules: Rules | None = None, project: Project | None = None
) -> tuple[Diagnostic, ...]:
    """The findings of the static check that the rules leave, in order of place.

    Without a ``project``, nothing is known of the modules that the document imports. Runs none of the program, and never
    raises.
    """
    try:
        surroundings_of = None if project is None else surroundings_in(project)
        found = check_text(text, filename=filename, surroundings_of=surroundings_of)
    except Exception as error:  # noqa: BLE001 - an editor must go on; the fault is shown in the document
        return (
            Diagnostic(
                "SC999",
                f"internal error: {type(error).__name__}: {error}",
                filename=filename,
                help="this is a fault of scenic, not of your program; please report it with the program",
            ),
        )
    return found if rules is None else rules.apply(found)
