class Box:
    width: 3
    length = 4
#   ^^^^^^ SC313 `length` is a property of `Box`, which an attribute of that name does
    depth = 2
    def size(self): return self.width
class Crate(Box):
    width = 5
#   ^^^^^ SC313 `width` is a property of `Crate`, which an attribute of that name does
    hieght: 4
#   ^^^^^^ SC300 `Crate` has no property `hieght` to give a default, so this line defin
    weight: 3
    lengths: [1]
    quality: 3
    colour: (1, 0, 0)
#   ^^^^^^ SC300 `Crate` has no property `colour` to give a default, so this line defin
a = new Box at 1, 2
#                 ^ SC311 this comma makes a tuple of the object and what follows
c = (new Box at (1, 2), 3)
d = new Box, new Box
e = new object
#       ^^^^^^ SC203 `object` is a name of Python, not a class of objects
f = new str
#       ^^^ SC203 `str` is a function of the language, not a class of objects
behavior Turn(speed=1):
    take speed
behavior Drive():
    Turn(2)
#   ^^^^^^^ SC312 this makes the behavior `Turn`, and nothing runs it
    do Turn(3)
    self.turn = Turn(4)
    take 3
monitor Watch():
    wait
scenario Inner():
    setup:
        new Box
Turn()
#^^^^^ SC312 this makes the behavior `Turn`, and nothing runs it
Watch()
#^^^^^^ SC312 this makes the monitor `Watch`, and nothing runs it
Inner()
#^^^^^^ SC312 this makes the scenario `Inner`, and nothing runs it
x = Turn(1)
new Box with behavior Drive, with quality 3
