behavior Guarded(limit, *zones, quiet=False):
    """All clauses that `try` can have."""
    precondition: limit > 0
    precondition: self.speed < 100
    invariant: self.speed >= 0
    count = 0
    try:
        try:
            do Basic(3)
            do Basic(4) until self.speed > 3
        interrupt when self.speed > limit:
            take ("brake", 1)
        interrupt when any(self in zone for zone in zones):
            do Basic(1) for 2 steps
            abort
    interrupt when simulation().currentTime > 50 and not quiet:
        count += 1
        if count > 3:
            terminate
        elif count > 2:
            wait
        else:
            take ("turn", 1), ("horn",)
    except GuardViolation as violation:
        print(violation)
        wait
    except (KeyError, IndexError):
        raise
    else:
        count = 0
    finally:
        print(f"left after {count} turns")
    return

behavior Basic(count):
    for number in range(count):
        take ("go", number)
    else:
        wait

class GuardViolation(Exception):
    pass

monitor Timer(limit=100):
    """End it all after a while."""
    start = simulation().currentTime
    while simulation().currentTime - start < limit:
        wait for 10 steps
        if quiet_now():
            continue
    terminate simulation

def quiet_now():
    global calls
    calls = calls + 1
    return calls % 2 == 0

calls = 0
zone = CircularRegion((10, 10, 0), 3)
ego = new Object at (0, 0, 0), with behavior Guarded(10, zone)
second = new Object at (30, 0, 0),
    with behavior Guarded(5, zone, quiet=True),
    facing toward ego
third = new Object at (0, 30, 0),
    with behavior Basic(2)

require monitor Timer(limit=50) as timer
require always second.speed < 10
require (ego.speed > 1) implies (eventually second.speed > 1)
record second.speed to "speed.csv" if calls else "other.csv"
terminate when third.speed > 20 as fast
