ego = new Object at (1, 2), at (3, 4)
#                           ^^^^^^^^^ SC301 `at` is given twice
new Object at (1, 2), in everywhere
#                     ^^^^^^^^^^^^^ SC301 `in` and `at` both give the position
new Object left of ego, ahead of ego by 3
#                       ^^^^^^^^^^^^^^^^^ SC301 `ahead of` and `left of` both give the position
new Object facing 3, with width 4, facing toward ego
#                                  ^^^^^^^^^^^^^^^^^ SC301 `facing toward` and `facing` both give the yaw
new Object with width 3, with length 4, with width 5
#                                       ^^^^^^^^^^^^ SC301 `with width` is given twice
new Object with position ego, at ego
#                             ^^^^^^ SC301 `at` and `with position` both give the position
new Object contained in everywhere, with regionContainedIn everywhere
#                                   ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ SC301
new Object facing 1, with roll 3
#                    ^^^^^^^^^^^ SC301 `with roll` and `facing` both give the roll
new Object on ego, on ego
#                  ^^^^^^ SC301 `on` is given twice
new Object at ego,
    facing 1,
    facing 2
    #^^^^^^^ SC301 `facing` is given twice
behavior B():
    override self at ego, at ego
    #                     ^^^^^^ SC301
    wait
new Object with orientation ego.orientation
#               ^^^^^^^^^^^ SC301 `orientation` is final
new Object with observations {}
#               ^^^^^^^^^^^^ SC301
new Object left of (0, 0, 0), facing toward (1, 1, 1)
#          ^^^^^^^^^^^^^^^^^ SC308 these properties depend on each other: `position` needs `orientation`
new Object above 1 @ 2, facing directly toward ego
#          ^^^^^^^^^^^ SC308
class Square:
    width: self.length
    length: self.width
    name[final]: "square"
new Square
#   ^^^^^^ SC308 these properties depend on each other
new Square with width 3
new Square left of ego
#   ^^^^^^ SC308
new Square with length 3, with name "other"
#                              ^^^^ SC301 `name` is final
class Turning:
    yaw: self.position.x
new Turning left of (0, 0)
#           ^^^^^^^^^^^^^^ SC308
new Turning left of ego
# These fit together.
new Object at ego, on ego
new Object at ego, facing toward ego, with pitch 3
new Object ahead of ego by 3, on ego, facing 3
new Object left of ego, with parentOrientation ego.orientation
new Object left of (0, 0, 0), facing 3
new Object left of ego, facing toward ego
new Object facing directly toward ego, with roll 3
new Object with colour 3, with colors 4
#               ^^^^^^ SC300
#                              ^^^^^^ SC300
new Point at ego
from cars import Car
new Car with heading 3, with orientation 4, at ego
