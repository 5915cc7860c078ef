"""Files beside a program on which its scenes and their images depend: meshes and textures."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from scenic.formats.textures import ImageTexture, TextureError, image_name, texture_of
from scenic.runtime.ground.context import warn
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.values.choices import options_of
from scenic.runtime.values.nodes import as_node

__all__ = ["check_textures", "mesh_files", "texts_of", "texture_files", "warn_of_textures"]


def texture_files(scenario: Scenario) -> list[Path]:
    """Return the image files that objects may have as textures."""
    folder = _folder(scenario)
    names = {name for thing in scenario.objects for name in _image_names(thing.__dict__.get("texture"))}
    return [path for name in sorted(names) if (path := folder / name).is_file()]


def check_textures(scenario: Scenario) -> None:
    """Read all image files that objects may have as textures, as far as the program alone tells them.

    Raises:
        TextureError: at the object, if a file cannot be read.

    """
    for error in _texture_errors(scenario):
        raise error


def warn_of_textures(scenario: Scenario) -> None:
    """Issue a `ScenicWarning` for each image file that `check_textures` refuses, as scenes can be sampled without it."""
    seen: set[str] = set()
    for error in _texture_errors(scenario):
        if error.message not in seen:
            seen.add(error.message)
            warn(error.message, code=error.code, span=error.span, filename=error.filename, help=error.help)


def _texture_errors(scenario: Scenario) -> Iterator[TextureError]:
    """Yield the errors of reading all image files that objects may have as textures."""
    folder = _folder(scenario)
    for thing in scenario.objects:
        for name in dict.fromkeys(_image_names(thing.__dict__.get("texture"))):
            texture = texture_of({"image": name}, (1, 1, 1), folder)
            assert isinstance(texture, ImageTexture)
            try:
                texture.image()
            except TextureError as error:
                place = scenario.program.places.get(id(thing), (None, None))
                yield error.at(place)


def _image_names(value: object) -> Iterator[str]:
    """Return the image files that a texture may name, as far as the program says them."""
    return (name for item in _constants(value) if (name := image_name(item)) is not None)


def texts_of(value: object) -> list[str]:
    """Return the texts that a random value may be, as far as the program says them; texts in tuples and lists count, too."""
    texts: list[str] = []
    for item in _constants(value):
        texts += [
            part for part in (item if isinstance(item, tuple | list) else [item]) if isinstance(part, str)
        ]
    return texts


def _constants(value: object) -> Iterator[Any]:
    """Yield the constants that a value is computed from."""
    nodes, left = set(), [as_node(value)]
    while left:
        node = left.pop()
        if node in nodes:
            continue
        nodes.add(node)
        left += reversed(node.operands)
        if node.is_constant:
            yield node.value


def _folder(scenario: Scenario) -> Path:
    return Path(scenario.filename).absolute().parent


def mesh_files(scenario: Scenario) -> list[Path]:
    """Return the mesh files of a scenario's shapes."""
    paths: dict[Path, None] = {}
    for thing in scenario.objects:
        shape = thing.__dict__.get("shape")
        for option in options_of(shape) or (shape,):
            source = getattr(option, "source", None)
            path = source.as_dict().get("path") if source is not None else None
            if isinstance(path, str | Path) and Path(path).is_file():
                paths[Path(path).absolute()] = None
    return list(paths)
