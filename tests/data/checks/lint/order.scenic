import math
print(first, math)
#     ^^^^^ SC204 `first` is used before it is defined
first = 3
second = second + 1
#        ^^^^^^ SC204
class Derived(Base): pass
#             ^^^^ SC204
class Base: pass
def function(default=late):
    #                ^^^^ SC204
    return later + late
later = 3
late = 4
for i in range(3):
    if i:
        print(in_loop)
    in_loop = i
try:
    print(tolerated)
except NameError:
    tolerated = 3
require wanted > 2
record wanted as wanted
terminate when wanted > 3
mutate moved
#      ^^^^^ SC204
wanted, moved = 3, new Object
deferred = lambda: much_later
much_later = 3
class Lazy:
    width: length
length = 3
abs = abs
behavior B():
    take action
action = 3
if first:
    conditional = 3
print(conditional)
def outer():
    local = 3
    return local
print(local)
#     ^^^^^ SC202 the name `local` is not defined here, only in the function `outer`
class Holder:
    kept = 3
    def method(self):
        return kept
        #      ^^^^ SC202 the name `kept` is not defined here, only in the body of the class `Holder`
new Holdr
#   ^^^^^ SC203 there is no class `Holdr`
new outer
#   ^^^^^ SC203 `outer` is a function, not a class
new first
#   ^^^^^ SC203 `first` is a plain value
new Uniform
#   ^^^^^^^ SC203 `Uniform` is a distribution of the language
new B
#   ^ SC203 `B` is a behavior
number = 4
new number
#   ^^^^^^ SC203 `number` is a plain value
class Table:
    size: 3
    width: size
    #      ^^^^ SC202 the name `size` is not defined; the property of the object is `self.size`
    color: velocity
    #      ^^^^^^^^ SC202 the name `velocity` is not defined; the property
