# Three costs that use up a budget, in fixed proportion.
a, b, c = Range(0, 100), Range(0, 100), Range(0, 100)
require 99 < a + b + c < 100
require a - b - c > 60
param costs = [a, b, c]
