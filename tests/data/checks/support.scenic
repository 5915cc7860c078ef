field = 3
print(field at (1, 2))
#     ^^^^^^^^^^^^^^^ SC900 the operator `at` is not supported in this version
new Object visible from field, with width 3
#          ^^^^^^^^^^^^^^^^^^ SC900 the specifier `visible`
new Object following field for 3
#          ^^^^^^^^^^^^^^^^^^^^^ SC900
mutate
#^^^^^ SC900 `mutate`
record field as x
#^^^^^^^^^^^^^^^^ SC900
terminate when field > 3
#^^^^^^^^^^^^^^^^^^^^^^^ SC900
require monitor field
#^^^^^^^^^^^^^^^^^^^^ SC900
require always field > 3
#       ^^^^^^^^^^^^^^^^ SC900 the temporal operator `always`
require (eventually field) and field > 3
#        ^^^^^^^^^^^^^^^^ SC900
require field > 3 implies field > 4
monitor M():
#^^^^^^^^^^^ SC900
    take 3
    #^^^^^ SC201
    wait
x = VectorField("x", field)
#   ^^^^^^^^^^^ SC900 `VectorField`
SectorRegion = 3
print(SectorRegion)
behavior B():
    terminate
    override self with speed 3
    take visible everywhere, simulation()
scenario S():
    setup:
        new Object
    compose:
        do S()
        #^^^^^ SC900 the compose block
def f(a):
    return a can see field
    #      ^^^^^^^^^^^^^^^ SC900
