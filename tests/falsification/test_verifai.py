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

PROGRAM = '''
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

# Every kind of external parameter: the points of Halton's sequence, and the reference's laws of what is discrete.
text = """
x = VerifaiRange(0, 1)
d = VerifaiDiscreteRange(1, 4)
o = VerifaiOptions({{10: 1, 20: 3}})
p = VerifaiParameter.withPrior(Range(2, 6))
param x = x, d = d, o = o, p = p
ego = new Object
"""
from scipy.stats import qmc
sampler = ScenicSampler.fromScenicCode(text)
points = [sampler.nextSample(None).params for _ in range(200)]
halton = qmc.Halton(2, scramble=False).random(201)[1:]
assert max(abs(point.x - row[0]) for point, row in zip(points, halton)) < 1e-12
assert max(abs((point.p - 2) / 4 - row[1]) for point, row in zip(points, halton)) < 1e-12
for name, values in (("d", (1, 2, 3, 4)), ("o", (10, 20))):
    counts = [sum(getattr(point, name) == value for point in points) for value in values]
    assert sum(counts) == 200 and min(counts) > 25, counts

# Its falsifier and tables.
from dotmap import DotMap
from verifai.falsifier import generic_falsifier
from verifai.monitor import specification_monitor
from verifai.scenic_server import ScenicServer

class Apart(specification_monitor):
    def __init__(self):
        super().__init__(lambda run: min(abs(places[0].y - places[1].y) for places in run.result.trajectory) - 3)

text = """
from scenic.simulators.kinematic import *
simulator KinematicSimulator(timestep=0.1)
gap = VerifaiRange(4, 30)
lead = new Object at (0, gap)
behavior Drive():
    while True:
        take SetVelocity((0, 2, 0))
ego = new Object with behavior Drive()
"""
falsifier = generic_falsifier(
    sampler=ScenicSampler.fromScenicCode(text),
    monitor=Apart(),
    falsifier_params=DotMap(n_iters=8, save_error_table=True, save_safe_table=True, fal_thres=0, verbosity=0, max_time=None),
    server_class=ScenicServer,
    server_options=DotMap(maxSteps=40, verbosity=0),
)
falsifier.run_falsifier()
assert len(falsifier.error_table.table) + len(falsifier.safe_table.table) == 8
assert (falsifier.error_table.table["rho"] <= 0).all() and len(falsifier.error_table.table) >= 1
'''


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
