"""The toolkit VerifAI, as published, on top of this package.

It requires the reference's distribution, which has the same import name as ours. So it is installed into a folder of its own, which comes
after ours on the path: ``pip install --target FOLDER verifai==2.2.0``, and ``SCENIC_VERIFAI=FOLDER``.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = os.environ.get("SCENIC_VERIFAI")

PROGRAM = """
import sys
sys.path.append({folder!r})
import scenic
from verifai.samplers.scenic_sampler import ScenicSampler
assert scenic.__file__.startswith({ours!r})
text = "x = VerifaiRange(0, 1)\\nparam x = x\\nego = new Object at Range(0, 3) @ 0, with color (0.1, 0.2, 0.3)\\nnew Object at 5 @ 5"
sampler = ScenicSampler.fromScenicCode(text)
points = [sampler.nextSample(feedback) for feedback in (None, 0.5, -0.5, 1.0)]
assert [point.params.x for point in points] == [0.5, 0.25, 0.75, 0.125]
assert all(0 <= point.objects.object0.position[0] <= 3 for point in points)
assert sampler.lastScene.params["x"] == 0.125
values = []
feedback = None
for _ in range(60):
    point = sampler.nextSample(feedback)
    feedback = abs(point.params.x - 0.3)
    values.append(feedback)
assert min(values) < 0.02
"""


@pytest.mark.slow
@pytest.mark.skipif(FOLDER is None, reason="no folder with VerifAI is named")
def test_verifai_samples_and_searches_with_this_package() -> None:
    ours = str(Path(__file__).parents[2])
    code = PROGRAM.format(folder=FOLDER, ours=ours)
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": ours},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
