# A field and a helper written in Python.
import math
wind = VectorField("wind", lambda p: 0.3 * math.sin(p.x / 20) + 0.01 * p.y)
def roomy(first, second):
    return (first.position - second.position).norm() > 6
ego = new Object at (Range(-50, 50), Range(-50, 50)), facing wind
other = new Object following wind from ego for Range(10, 20)
third = new Object at (Range(-50, 50), Range(-50, 50)), facing 0.2 relative to wind
require roomy(ego, third) and roomy(other, third)
