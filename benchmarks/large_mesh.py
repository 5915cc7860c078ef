"""Times of a mesh of 200,000 triangles: to load it, and to place something on it, in a process of its own.

python -m benchmarks.large_mesh
"""

import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

PROGRAM = """
rock = new Object with shape MeshShape.fromFile(localPath('rock.ply')), with width Range(3, 6),
    with height Range(1, 2), facing (Range(0, 360) deg, Range(-20, 20) deg, Range(-20, 20) deg)
ego = new Object on rock, with width 0.2, with length 0.2, with height 0.2, with baseOffset (0, 0, -0.3)
"""
"""A small box on a rock of random width and tilt, above it by enough not to cut its bumps."""


def write_rock(path: Path) -> int:
    """Write a bumpy ellipsoid as a mesh file; returns its number of triangles."""
    import trimesh

    mesh = trimesh.creation.uv_sphere(count=[225, 225])
    x, y, z = mesh.vertices.T
    bumps = 1 + 0.05 * np.sin(9 * x) * np.cos(7 * y) + 0.03 * np.sin(13 * z)
    rock = trimesh.Trimesh(mesh.vertices * bumps[:, None], mesh.faces, process=False)
    rock.export(path)
    return len(rock.faces)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        faces = write_rock(Path(folder, "rock.ply"))
        program = Path(folder, "rock.scenic")
        program.write_text(PROGRAM)
        start_time = time.perf_counter()
        import scenic

        scenario = scenic.load(program)
        loaded = time.perf_counter()
        scenario.sample(1, seed=1)
        first = time.perf_counter()
        scenario.sample(20, seed=2)
        done = time.perf_counter()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    print(f"{faces} triangles")
    print(f"import and load   {loaded - start_time:7.2f} s")
    print(f"first scene       {first - loaded:7.2f} s")
    print(f"each further one  {(done - first) / 20:7.3f} s")
    print(f"peak memory       {peak / 2**20:7.0f} MiB")


if __name__ == "__main__":
    main()
