scenario Traffic(density, speed=10):
    precondition: 0 < density < 1
    invariant: speed > 0
    setup:
        count = int(density * 10)
        cars = []
        for index in range(count):
            car = new Object at (index * 6, 40, 0),
                with width 2,
                with length 4,
                with behavior Drive(speed)
            cars.append(car)
        require count > 0
    compose:
        while True:
            wait

scenario Jam():
    setup:
        param jam = True
        block = new Object at (0, 80, 0), with width 10
        monitor Stuck():
            while block is not None:
                wait
            terminate
        require monitor Stuck()

scenario Quiet:
    ego = new Object at (0, 0, 0)
    terminate after 5 seconds

behavior Drive(speed):
    do Straight(speed) for 3 seconds
    do Turn(30 deg) until self.heading > 1
    while True:
        do Straight(speed / 2)

behavior Straight(speed):
    take ("straight", speed)

behavior Turn(angle):
    take ("turn", angle)
    wait

def weights(first, second):
    return {first: 1, second: 2}

scenario Main():
    setup:
        ego = new Object at (0, -20, 0),
            with behavior Drive(12),
            facing 0 deg
        chosen = Uniform(0.2, 0.4)
    compose:
        traffic = Traffic(chosen)
        jam = Jam()
        do traffic, jam for 10 seconds
        do choose weights(traffic, jam)
        do shuffle {traffic: 1, jam: 3}
        try:
            do traffic until jam is None
        interrupt when ego.position.y > 30:
            override ego with behavior Turn(1)
            wait
        interrupt when ego.position.y > 60:
            override ego with width 2,
                with behavior Straight(3),
                with height 4
            terminate
        require ego.position.x < 5
        do jam
