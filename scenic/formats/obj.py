"""A scene as Wavefront OBJ, which nearly every 3D program reads, with its colours in a material library (MTL) beside it.

Coordinates are those of the scene: metres, Z up, Y ahead. Each object is a group of its own, in the order of the scene, so that
a program reads back what this one would.
"""

from collections.abc import Iterator
from typing import Final

import numpy as np

from scenic.formats.mesh_instances import MeshInstance, MeshSurface, distinct_labels, picture
from scenic.formats.poses import Four
from scenic.formats.scene_protocols import Scene

_DIGITS: Final = ".9g"


def obj(scene: Scene, library: str) -> tuple[bytes, bytes]:
    """Return the contents of an ``.obj`` file and of its material library.

    Args:
        scene: the scene.
        library: the name of the library's file, which has to lie beside the other.

    """
    scene_picture = picture([scene])
    instances = scene_picture.scenes[0]
    materials: dict[Four, str] = {}
    for instance in instances:
        for color in _colors(instance, scene_picture.surfaces[instance.surface]):
            materials.setdefault(color, f"color{len(materials)}")
    lines = [f"# scene {scene.k} of seed {scene.seed}; metres, Z up", f"mtllib {library}"]
    first = 1
    for instance, name in zip(instances, distinct_labels(instances), strict=True):
        surface = scene_picture.surfaces[instance.surface]
        lines.append(f"o {name}".replace("\n", " "))
        lines += _surface(instance, surface, first, materials)
        first += len(surface.vertices)
    return _encoded(lines), _encoded(_materials(materials))


def _colors(instance: MeshInstance, surface: MeshSurface) -> list[Four]:
    """The colours of the object's faces, in the order of `MeshSurface.painted`."""
    return [
        instance.color if paint is None else (*paint, instance.color[3]) for paint, _ in surface.painted()
    ]


def _surface(
    instance: MeshInstance, surface: MeshSurface, first: int, materials: dict[Four, str]
) -> Iterator[str]:
    """Yield the lines of an object whose corners are numbered from ``first`` on."""
    matrix = instance.matrix()
    corners = surface.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    # Normals of the unit box turn and scale by the inverse transpose.
    normals = surface.normals @ np.linalg.inv(matrix[:3, :3])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    yield from (f"v {x:{_DIGITS}} {y:{_DIGITS}} {z:{_DIGITS}}" for x, y, z in corners.tolist())
    yield from (f"vn {x:.6f} {y:.6f} {z:.6f}" for x, y, z in normals.tolist())
    for color, (_, faces) in zip(_colors(instance, surface), surface.painted(), strict=True):
        yield f"usemtl {materials[color]}"
        for a, b, c in (faces + first).tolist():
            yield f"f {a}//{a} {b}//{b} {c}//{c}"


def _materials(materials: dict[Four, str]) -> Iterator[str]:
    for (red, green, blue, alpha), name in materials.items():
        yield f"newmtl {name}"
        yield f"Kd {red:.6g} {green:.6g} {blue:.6g}"
        yield f"d {alpha:.6g}"
        yield "illum 1"


def _encoded(lines: list[str] | Iterator[str]) -> bytes:
    return ("\n".join(lines) + "\n").encode()
