"""Runs that continue the JSON Lines of an earlier run."""

import json
from collections.abc import Callable

from scenic.formats.growing import GrowingFile
from scenic.language.errors import Located

__all__ = ["ResumeError", "check_remade", "continued"]


class ResumeError(Located):
    """The error for lines that a run cannot continue."""

    code = "SC609"


def continued(
    grown: GrowingFile,
    digest: str,
    seed: int | None,
    first: int,
    count: int,
    *,
    points: str | None = None,
    files: str | None = "",
) -> tuple[int | None, int]:
    """The seed of the run that is resumed, and how many of its scenes are done.

    ``points`` is what scenes are made of, if not of random numbers. ``files`` is a digest of the files that decide the scenes, which
    is not compared if ``None``. Raises `ResumeError` where the lines are of another program, of other options or of another run.
    """
    lines = grown.kept()
    if not lines:
        return seed, 0
    try:
        head, last = (json.loads(line) for line in (lines[0], lines[-1]))
        recorded_run, first_number, last_number = (
            (head["digest"], int(head["seed"])),
            int(head["k"]),
            int(last["k"]),
        )
        same = recorded_run == (last["digest"], int(last["seed"]))
        alike = head.get("points") == last.get("points") == points
        has_same_files = files is None or last.get("files", "") == files
    except (ValueError, KeyError, TypeError) as error:
        raise ResumeError(f"'{grown.path}' does not hold scenes of an earlier run ({error})") from error
    if recorded_run[0] != digest:
        raise ResumeError(
            f"'{grown.path}' holds scenes of another program, or of the same with other options",
            help="the program has changed since: sample to a new file",
        )
    if not has_same_files:
        raise ResumeError(
            f"'{grown.path}' holds scenes of the same program with other modules, meshes or other files that it uses",
            help="put the files back, or sample to a new file; --accept-changes goes on, and each line tells by `files` which it is of",
        )
    if not alike:
        raise ResumeError(
            f"'{grown.path}' holds scenes of other random numbers",
            help="give --sobol as in the run that is resumed, or leave it away as there",
        )
    if (
        not same
        or (seed is not None and seed != recorded_run[1])
        or not first <= first_number
        or last_number >= first + count
    ):
        raise ResumeError(
            f"'{grown.path}' holds scenes {first_number} to {last_number} of seed {recorded_run[1]}, which this run does not make",
            help="give the same --seed, --first and -n as before, or a larger -n",
        )
    return recorded_run[1], last_number + 1 - first


def check_remade(grown: GrowingFile, files: str, line_of: Callable[[int], bytes | None]) -> None:
    """Raise `ResumeError` if the first or the last kept scene is not what the run would write now.

    Args:
        grown: the file.
        files: the digest of the files that decide the scenes now; lines of others are not compared.
        line_of: makes the line of a scene of a number, or ``None`` if it is not found.

    """
    lines = grown.kept()
    for line in dict.fromkeys([*lines[:1], *lines[-1:]]):
        scene = json.loads(line)
        number = int(scene["k"])
        if scene.get("files", "") == files and line_of(number) != line:
            raise ResumeError(
                f"scene {number} in '{grown.path}' is not the one that this run makes",
                help="give the same options (--no-prune, --properties, --max-attempts) and the same versions as before, or sample to"
                " a new file; --accept-changes goes on",
            )
