def function(a, b, c=3, *, d, e=4): return a, b, c, d, e
function(1, 2, d=3)
function(1, 2, 3, 4, d=5)
#                 ^ SC211 the function `function` takes 3 arguments, and 4 are given
function(1, d=3)
#^^^^^^^^^^^^^^^ SC211 the function `function` needs `b`
function()
#^^^^^^^^^ SC211 the function `function` needs `a`, `b` and `d`
function(1, 2, d=3, depht=4)
#                   ^^^^^ SC211 the function `function` has no parameter `depht`
function(1, 2, d=3, a=4)
#                   ^ SC211 the function `function` is given `a` twice
function(*[1], d=3)
function(1, **{})
function(*[1], f=3)
#              ^ SC211
def open_ended(*args, **kwargs): return args, kwargs
open_ended(1, 2, 3, a=4)
def positional(a, /, b): return a, b
positional(1, b=2)
positional(a=1, b=2)
#          ^ SC211
behavior Drive(speed, lane=3):
    wait
behavior Idle():
    wait
new Object with behavior Drive(3)
new Object with behavior Drive()
#                        ^^^^^^^ SC211 the behavior `Drive` needs `speed`
new Object with behavior Drive
#                        ^^^^^ SC211 the behavior `Drive` needs `speed`
new Object with behavior Idle
new Object with behavior Drive(spede=3)
#                              ^^^^^ SC211
new Object with behavior Drive(1, spede=3)
#                                 ^^^^^ SC211
behavior Other():
    do Idle
    #  ^^^^ SC314 this names the behavior `Idle`, and makes none
    do Drive
    #  ^^^^^ SC211
    #  ^^^^^ SC314
    do Drive(3)
    do plain()
    #  ^^^^^^^ SC211 `do` runs behaviors and scenarios, and `plain` is a plain function that returns nothing
    do plain
    #  ^^^^^ SC211
    do maker()
    do Idle(3)
    #       ^ SC211 the behavior `Idle` takes no arguments, and 1 is given
def plain(): print(3)
def maker(): return Idle()
class Car:
    width: 3
    def move(self, distance, *, fast=False):
        self.move(distance)
        self.move()
        #^^^^^^^^^^ SC211 the method `move` needs `distance`
        self.move(distance, 3)
        #                   ^ SC211 the method `move` takes 1 argument
        self.move(distance, quick=3)
        #                   ^^^^^ SC211
        self.unknown(3)
        return fast
def replaced(): pass
replaced = open_ended
replaced(3)
import functools
@functools.cache
def decorated(): pass
decorated(3)
def local_only():
    def inner(a): return a
    return inner(), inner(1)
    #      ^^^^^^^ SC211
class Base:
    def act(self):
        raise NotImplementedError
    def run(self):
        self.act(3)
