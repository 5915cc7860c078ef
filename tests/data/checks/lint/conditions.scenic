x = new Object
require True
#       ^^^^ SC306 this requirement always holds
require 3 > 2 as constant
#       ^^^^^ SC306
require not 1
#       ^^^^^ SC306 this requirement never holds
require (x.width > 3, x.length > 4)
#       ^^^^^^^^^^^^^^^^^^^^^^^^^^^ SC306 this requirement is a tuple, which is always true
require x.width == 1 or 2
#       ^^^^^^^^^^^^^^^^^ SC306 this requirement always holds
require x.width > 1 and False
#       ^^^^^^^^^^^^^^^^^^^^^ SC306 this requirement never holds
require x.width == x.width
#       ^^^^^^^^^^^^^^^^^^ SC306 `x.width` is compared with itself, which always holds
require x.width < x.width
#       ^^^^^^^^^^^^^^^^^ SC306 `x.width` is compared with itself, which never holds
require[1] x.width > 3
#      ^^^ SC306 a requirement of probability 1
require[0] x.width > 3
#      ^^^ SC306 a requirement of probability 0
if 0:
#  ^ SC306 this condition never holds
    print(3)
while False:
#     ^^^^^ SC306
    print(3)
while 1:
    break
y = 3 if "text" else 4
#        ^^^^^^ SC306
def close(): return y
def near(a): return a
require close
#       ^^^^^ SC306 this requirement is the function `close` itself
require near
#       ^^^^ SC306
if close:
#  ^^^^^ SC306
    print(3)
require close()
require near(3) and close
require[0.5] x.width > 3
require x.width != x.width
require x.width > y
require x.width or y
require 0 < y < 1
assert False
z = close() or 3
if []:
#  ^^ SC306
    print(z)
if [*z]:
    print(z)
def nothing():
    while False:
        yield
def still_nothing():
    if False:
        yield
print(nothing, still_nothing)
