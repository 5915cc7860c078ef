field = 3
print(field at (1, 2))
new Object visible from field, with width 3
new Object following field for 3
mutate
record field as x
terminate when field > 3
require monitor field
require always field > 3
require (eventually field) and field > 3
require field > 3 implies field > 4
monitor M():
    take 3
    #^^^^^ SC201
    wait
x = VectorField("x", field)
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
def f(a):
    return a can see field
