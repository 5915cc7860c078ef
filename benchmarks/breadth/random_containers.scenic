# Lists and tuples drawn, sliced, unpacked and filtered.
sizes = Uniform([1, 2, 3], [0.5, 1.5, 2.5], [1, 1, 1])
places = Uniform([(0, 0), (10, 0), (20, 0)], [(0, 10), (10, 10), (20, 10)])
ego = new Object at places[0], with width sizes[0]
a = new Object at places[1], with width max(*sizes)
b = new Object at places[2], with width Uniform(*filter(lambda size: size > 0.7, sizes))
param total = sizes[0] + sizes[1], count = len(sizes[1:])
require a.width >= ego.width
