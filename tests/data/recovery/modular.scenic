"""Scenarios that are made of others."""

scenario Approach(gap=10):
    precondition: gap > 0
    setup:
        ego = new Object at (0, 0, 0),
            with width 2,
            with behavior Hold(3)
        lead = new Object ahead of ego by gap, facing 0 deg
        require (distance from ego to lead) >= gap - 1
        record (distance from ego to lead) every 3 steps as gap
    compose:
        do Wave(3), Wave(5)
        wait

scenario Wave(count):
    setup:
        marker = new Object at (count, 5, 0), with width 0.2
        terminate after 4 seconds
    compose:
        for step in range(count):
            wait
        terminate

scenario Detour():
    ego = new Object at (20, 0, 0)
    sign = new Object left of ego by 2,
        with height 2,
        with name "sign"
    require (altitude from ego to sign) < 90 deg

behavior Hold(count):
    for step in range(count):
        take ("hold", step)
    wait until self.position.x > 3

scenario Main(order=True):
    setup:
        start = Range(5, 15)
        if order:
            limit = 3
        else:
            limit = 4
        require limit < 5
    compose:
        first = Approach(gap=start)
        second = Detour()
        try:
            do first, second for 30 seconds
            do Wave(2)
        interrupt when initial scenario:
            do Wave(1) until second is None
        if order:
            do shuffle Wave(1), Wave(2)
        elif limit > 3:
            do choose Wave(3), Wave(4)
        else:
            terminate simulation
        override first.lead with width 3, with length 4
        wait
