behavior Nested(depth):
    level = 0
    while level < depth:
        if level % 2 == 0:
            for step in range(level):
                if step > 3:
                    try:
                        take ("inner", step)
                        wait
                    interrupt when level > 5:
                        take ("outer", level)
                    interrupt when level > 7:
                        if step == 4:
                            take ("deepest",)
                        else:
                            wait
                else:
                    wait
            take ("even", level)
        else:
            try:
                do Sub(level)
            interrupt when self.speed > 3:
                while self.speed > 3:
                    take ("slow", 1)
                abort
        level += 1
    do Sub(depth)

behavior Sub(level):
    with_note = level
    try:
        value = 10 / with_note
    except ZeroDivisionError:
        value = 0
    except (TypeError, ValueError) as error:
        print(error)
        value = 1
    else:
        value += 1
    finally:
        print(value)
    take ("sub", value)

scenario Outer():
    setup:
        ego = new Object at (0, 0, 0),
            with speed 3,
            with behavior Nested(3)
        for index in range(3):
            thing = new Object at (index * 3 + 3, 0, 0),
                with width 0.5
            if index == 1:
                require thing.width < 1
            else:
                require thing.width < 2
    compose:
        while True:
            do Part(1)
            if ego.position.x > 3:
                do Part(2), Part(3)
            else:
                wait
                for index in range(3):
                    do Part(index) until index > 2
            wait

scenario Part(number):
    compose:
        wait for number + 1 seconds
        terminate
