scenario Traffic(density speed):
    precondition: density > 0
    setup:
        count = density * * 10
        ego = new Car
    compose:
        do Drive() untl ego.speed > 3
        wait
scenario Jam():
    setup
        ego = new Car
    compose:
        try:
            do Drive()
        interrupt when ego.speed > > 3:
            wait wait
        interrupt whn ego.stopped:
            abort
        except (A, B) C:
            terminate
        else:
            wait
match kind:
    case "car" "truck" | | "bus":
        a = 1
    case [first, *_] iff first:
        b = 2
    case _:
        c = 3 3
for a in b
    c
elsee:
    d d
last = 8
