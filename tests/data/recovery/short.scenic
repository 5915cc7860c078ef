param a = 1
ego = new Object at (0, 0, 0)
x = Range(1, 2)
y = x * 2
if y is not None:
    z = 3
else:
    z = 4
other = new Object at (x + 5, y, z), with width 2
for i in range(3):
    new Object at (i * 4, 20, 0)
while z > 10:
    z -= 1
print(x, y, z)
require x > 1.2
require y < 3.5
require other.width == 2
def f(n):
    return n + 1
w = f(3)
require w > 3
v = [w, z]
new Object at (v[0], 40, 0), facing 30 deg
require (distance from ego to other) > 1
terminate when x > 3
