import os
def f(x):
    value = 3
    return x x
new Object at (1, 2), at (3, 4)
#                     ^^^^^^^^^ SC301
