if a:
    b
elif c d:
    e
else:
    f
try:
    a
excpt B:
    c
iff x:
    y
else:
    z
else:
    w
for x on y:
    z
while x
    y
    z z
def f():
g = 3
  h = 4
    i = 5
match x:
    case 1 2:
        pass
    case [a, *b]:
        a b
