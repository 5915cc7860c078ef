# Time to collision below 1.5 seconds.
gap = Range(2, 120)
v1, v2 = Range(5, 40), Range(5, 40)
require gap < 1.5 * (v1 - v2)
require gap > 20
param gap = gap, v1 = v1, v2 = v2
