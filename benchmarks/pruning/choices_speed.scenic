# Vehicle types with speeds, and a meeting point.
v1, v2 = Uniform(5, 8, 13, 21), Uniform(5, 8, 13, 21)
t = Range(0, 100)
require 990 < v1 * t + v2 * t < 1000
require v2 > v1
param meet = [v1, v2, t]
