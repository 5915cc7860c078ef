# One of 3,000 places with directions.
import random
rng = random.Random(3)
places = [new OrientedPoint at (rng.uniform(-500, 500), rng.uniform(-500, 500)), facing rng.uniform(-3, 3) for i in range(3000)]
ego = new Object at Uniform(*places), with width 0.5
other = new Object ahead of Uniform(*places) by Range(2, 4)
require (distance from ego to other) > 20
