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
halton = qmc.Halton(1, scramble=False).random(201)[1:]
assert max(abs(point.x - row[0]) for point, row in zip(points, halton)) < 1e-12
assert all(2 <= point.p <= 6 for point in points)
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

UPDATES = """
import random
import sys
sys.path.append({folder!r})
import numpy as np
from dotmap import DotMap
from verifai.features import Box, DiscreteBox, Feature, FeatureSpace
from verifai.samplers.feature_sampler import FeatureSampler
from scenic.falsification.samplers.buckets import Bandit, CrossEntropy
from scenic.falsification.space import Coordinate, Space

space = FeatureSpace(dict(x=Feature(Box((0.0, 1.0))), y=Feature(Box((2.0, 5.0))), d=Feature(DiscreteBox((1, 4)))))
ours = Space((Coordinate(1, "x"), Coordinate(2, "y", 2, 5), Coordinate(3, "d", 1, 4, 4)))
weights = [[0.1, 0.2, 0.3, 0.4], [0.25] * 4]

def settings(case):
    found = DotMap(alpha=0.8, thres=0.1) if case else DotMap(alpha=0.9, thres=0.0)
    found.cont.buckets, found.cont.dist = (4, np.array(weights)) if case else (5, None)
    found.disc.dist = np.array(weights[:1]) if case else None
    return found

for seed in range(4):
    np.random.seed(seed)
    random.seed(seed)
    rng = np.random.default_rng(seed)
    for name in ("ce", "mab"):
        given = settings(seed % 2)
        make = FeatureSampler.crossEntropySamplerFor if name == "ce" else FeatureSampler.multiArmedBanditSamplerFor
        theirs = make(space, settings(seed % 2))
        mine = (CrossEntropy if name == "ce" else Bandit)(ours, 0, given)
        parts = theirs.domainSampler
        feedback = None
        for step in range(200):
            point = theirs.nextSample(feedback)
            if step and name == "ce":
                known = [*parts.cont_sampler.dist, *parts.disc_sampler.dist]
                assert all(np.allclose(a, b, atol=1e-12) for a, b in zip(mine.distributions, known, strict=True)), step
            if name == "mab":
                assert np.array_equal(mine.counts[:2], parts.cont_sampler.counts), step
                assert np.array_equal(mine.errors[:2], parts.cont_sampler.errors), step
                for bound, bucket in zip(mine.bounds()[:2], parts.cont_sampler.current_sample, strict=True):
                    assert bound[bucket] > bound.max() - 1e-12, step
            row = np.array([[point.x[0], (point.y[0] - 2) / 3, (point.d[0] - 0.5) / 4]])
            feedback = float(rng.choice([-0.5, 0.0, 0.1, 0.2, 1.0]))
            mine.tell(row, np.array([feedback]))
"""


@pytest.mark.slow
@pytest.mark.skipif(FOLDER is None, reason="no folder with VerifAI is named")
@pytest.mark.parametrize("program", [PROGRAM, UPDATES], ids=["samples", "updates"])
def test_verifai_runs_on_this_package_and_learns_alike(program: str) -> None:
    ours = str(Path(__file__).parents[2])
    code = program.format(folder=FOLDER, ours=ours)
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": ours},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
