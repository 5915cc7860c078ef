x = 1 +
y = 2
x = Object facing 3
f(1, 2 3)
if x = 3:
    y = 4
    z = 5 6
else:
    w = 7 8
print "x"
z = 3
param x = , y = 3
require
take
record x every 3
