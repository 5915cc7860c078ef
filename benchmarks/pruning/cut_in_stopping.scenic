# The car behind can just stop, by the formula for its braking distance.
v, a, gap = Range(5, 40), Range(2, 9), Range(1, 200)
require 0 < gap - v * v / (2 * a) < 1
require v > 30
param v = v, a = a, gap = gap
