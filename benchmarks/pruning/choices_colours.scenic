# Colours of three cars by number: all different, and adding up.
a, b, c = Uniform(1, 2, 4, 8, 16), Uniform(1, 2, 4, 8, 16), Uniform(1, 2, 4, 8, 16)
require a + b + c == 21
require a > b and b > c
param colours = [a, b, c]
