a = f(1,
def g(x):
    return [x
class C:
    y: (3]
    z: 4
b = )
c = {1: 2, 3}
d = [1 2]
e = f"{a b}" + f"{c"
g = 'abc
h = 3
