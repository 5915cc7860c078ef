import os
def f(x):
    value = 3
    return locals()
f(1, 2, 3)
later = 3
