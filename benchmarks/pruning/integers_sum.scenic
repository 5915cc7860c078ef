# Crew of a given size, in four groups.
a, b, c, d = (DiscreteRange(0, 20) for i in range(4))
require a + b + c + d == 23
require a > b + c
require c == 2 * d
param crew = [a, b, c, d]
