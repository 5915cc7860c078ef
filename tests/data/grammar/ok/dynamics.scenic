behavior B(x, *, y=3):
    """What it does."""
    precondition: x > 3
    invariant: y
    take a, b
    take (a, b)
    wait; wait for 3 seconds; wait until x
    do C()
    do C(), D()
    do C() if x else D()
    do C() for 3 steps
    do C() until x
    do (C() if x else D()) until y
    do choose A(), B()
    do choose {A(): 1, B(): 2}
    do shuffle A(), B()
    try:
        do A()
    interrupt when x:
        abort
    interrupt when y:
        terminate
    except E as e:
        terminate simulation
    else:
        pass
    finally:
        pass
behavior C():
    "only documentation"
behavior D(): take a
monitor M():
    invariant = 3
    while True: wait
scenario S(a=1):
    """What it is."""
    precondition: x
    setup:
        ego = new Object
        override ego with behavior C
    compose:
        do A(), B()
scenario T:
    setup: pass
scenario U:
    compose:
        wait
scenario V():
    """A block."""
    ego = new Object
    terminate after 3 seconds
try:
    x
except* E:
    y
