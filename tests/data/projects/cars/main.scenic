model lib.model
from lib import tools
from lib.tools import Brake, Steer as Turn, Unknown, cached, plain, plian
#                                                                   ^^^^^ SC212 the module `lib.tools` has no `plian`
import math, lib.base as base
from math import pi as half, sinus
#                            ^^^^^ SC212 the module `math` has no `sinus`
ego = new Car with speed 3, with wheels 3
new Car with sped 3
#            ^^^^ SC300 `Car` has no property `sped`, so `with` creates it
new Truck with load 3
#              ^^^^ SC301 `load` is final, so it cannot be given
new Truck with weels 3
#              ^^^^^ SC300 `Truck` has no property `weels`, so `with` creates it
new Crossing
#   ^^^^^^^^ SC203 `Crossing` is a scenario, not a class
new Cra
#   ^^^ SC203 there is no class `Cra`
new Object left of egoo by roadway
#                  ^^^^ SC202 the name `egoo` is not defined
new Object with behavior Drive(1, 2, brake=3)
new Object with behavior Drive(1, 2, 3)
#                                    ^ SC211 the behavior `Drive` takes 2 arguments, and 3 are given
new Object with behavior Drive
#                        ^^^^^ SC211 the behavior `Drive` needs `target`
new Object with behavior Drive(1, brakes=3)
#                                 ^^^^^^ SC211 the behavior `Drive` has no parameter `brakes`
new Car with behavior plain(1)
print(_hidden, helper)
#     ^^^^^^^ SC202 the name `_hidden` is not defined
print(lanes(3), lanes(), lane, base.helper, base.helpers, half)
#               ^^^^^^^ SC211 the function `lanes` needs `count`
#                        ^^^^ SC202 the name `lane` is not defined
#                                                ^^^^^^^ SC212 the module `lib.base` has no `helpers`
print(math.tau, math.tav, tools.plain(1, 2, 3), tools.plain(), tools.nothing)
#                    ^^^ SC212 the module `math` has no `tav`
#                                               ^^^^^^^^^^^^^ SC211 the function `plain` needs `a`
#                                                                    ^^^^^^^ SC212 the module `lib.tools` has no `nothing`
print(Brake(), Brake(1), Turn(1, 2), Turn(1, rate=2), Unknown(1, 2), cached(3), plian())
#     ^^^^^^^ SC211 the class `Brake` needs `force`
#                                ^ SC211 the class `Steer` takes 1 argument, and 2 are given
print(Range(1), Range(1, 2, 3), Range(1, 2), DiscreteRange(1, 2, [3, 4]), Normal(0), sin(), Discrete({1: 2}))
#     ^^^^^^^^ SC211 the distribution `Range` needs `high`
#                           ^ SC211 the distribution `Range` takes 2 arguments, and 3 are given
#                                                                         ^^^^^^^^^ SC211 the distribution `Normal` needs `stdDev`
#                                                                                    ^^^^^ SC211 the function `sin` needs `x`
print(math.__name__, tools.Base.missing, Vehicle)
