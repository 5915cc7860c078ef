"""The state of an installation: versions, extras, the cache, rendering, and packages that get in the way."""

import importlib.util
import os
import platform
import re
from collections.abc import Iterator
from enum import StrEnum
from importlib import metadata
from pathlib import Path

import scenic
from scenic.dataclass import dataclass
from scenic.language.extras import EXTRAS, installation
from scenic.runtime.geometry.store import kept_files, store_folder

__all__ = ["InstallationFinding", "State", "findings"]


class State(StrEnum):
    """The weight of a finding: ``fine``, ``missing`` for what is optional, or ``problem``."""

    FINE = "fine"
    MISSING = "missing"
    PROBLEM = "problem"


@dataclass(frozen=True, slots=True)
class InstallationFinding:
    """One thing that was looked at; ``help`` says what to do."""

    subject: str
    state: State
    text: str
    help: str | None = None


def findings() -> Iterator[InstallationFinding]:
    """Everything worth knowing about this installation, in the order in which a reader needs it."""
    yield InstallationFinding(
        "Python", State.FINE, f"{platform.python_version()} on {platform.platform(terse=True)}"
    )
    yield _package()
    yield from _rivals()
    yield from _requirements()
    yield from _extras()
    yield _cache()
    yield _rendering()


def _package() -> InstallationFinding:
    place = Path(scenic.__file__).parent
    try:
        return InstallationFinding("scenic-lang", State.FINE, f"{metadata.version('scenic-lang')} in {place}")
    except metadata.PackageNotFoundError:
        return InstallationFinding("scenic-lang", State.FINE, f"not installed, run from {place}")


def _rivals() -> Iterator[InstallationFinding]:
    """Yield other distributions that bring a package of the same name: which one is imported is then a matter of luck."""
    for name in sorted(set(metadata.packages_distributions().get("scenic", [])) - {"scenic-lang"}):
        yield InstallationFinding(
            name,
            State.PROBLEM,
            f"the distribution '{name}' brings a package `scenic`, too",
            f"remove one of the two: pip uninstall {name}; then pip install --force-reinstall scenic-lang",
        )


def _requirements() -> Iterator[InstallationFinding]:
    try:
        requirements = metadata.requires("scenic-lang") or []
    except metadata.PackageNotFoundError:
        requirements = []
    versions = []
    for requirement in requirements:
        if "extra ==" in requirement:
            continue
        name = re.split(r"[^A-Za-z0-9_.-]", requirement)[0]
        try:
            versions.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            yield InstallationFinding(
                name, State.PROBLEM, "is required and not installed", f"pip install '{requirement}'"
            )
    if versions:
        yield InstallationFinding("requirements", State.FINE, ", ".join(versions))


def _extras() -> Iterator[InstallationFinding]:
    for extra in EXTRAS.values():
        absent = [module for module in extra.modules if importlib.util.find_spec(module) is None]
        if absent:
            yield InstallationFinding(
                f"extra {extra.name}",
                State.MISSING,
                f"not installed ({extra.purpose})",
                installation(extra.name),
            )
        else:
            yield InstallationFinding(f"extra {extra.name}", State.FINE, extra.purpose)


def _cache() -> InstallationFinding:
    folder = store_folder()
    if folder is None:
        return InstallationFinding(
            "cache", State.FINE, "turned off by SCENIC_CACHE, or without a home folder"
        )
    nearest = next(path for path in (folder, *folder.parents) if path.exists())
    if not os.access(nearest, os.W_OK):
        return InstallationFinding(
            "cache", State.PROBLEM, f"{folder} cannot be written", "name another folder in SCENIC_CACHE_DIR"
        )
    size = sum(size for _, size, _ in kept_files(folder))
    return InstallationFinding("cache", State.FINE, f"{size / 2**20:.1f} MiB in {folder}")


def _rendering() -> InstallationFinding:
    """Return whether an image can be made without a graphics card."""
    # These bring in NumPy and the geometry libraries.
    from scenic.formats.mesh_instances import picture
    from scenic.formats.render import render
    from scenic.pipeline import scenarioFromString

    try:
        scenes = scenarioFromString("ego = new Object").sample(1, seed=1)
        pixels = render(picture(scenes), 0, (32, 24))
    except Exception as error:  # noqa: BLE001 - whatever is wrong is what the user wants to know
        return InstallationFinding(
            "rendering", State.PROBLEM, f"fails: {error}", "report this with the output of this command"
        )
    return InstallationFinding(
        "rendering", State.FINE, f"works without a graphics card ({pixels.shape[1]} x {pixels.shape[0]})"
    )
