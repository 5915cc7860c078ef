def function(x):
    if x:
        return 3
        print(x)
        #^^^^^^^ SC303 this code is never reached
    else:
        raise ValueError
    print(x)
    #^^^^^^^ SC303
def generator():
    return
    yield
def loops(x):
    while True:
        if x:
            break
            x = 3
            #^^^^ SC303
        continue
        x += 1
        #^^^^^ SC303
    for i in x:
        pass
    while True:
        x += 1
        for i in x:
            break
    return x
    #^^^^^^^ SC303
def falls_through(x):
    if x:
        return 3
    elif x > 2:
        return 4
    return 5
def caught(x):
    try:
        return 3
    except ValueError:
        x = 3
    return x
behavior Drive():
    take 3
    terminate
    take 4
    #^^^^^ SC303
behavior Hangs(x):
    while True:
    #^^^^^^^^^^ SC304 this loop never lets time pass
        x = x + 1
        if x > 3:
            for i in x:
                break
    wait
behavior Stops(x):
    while True:
        if x:
            break
    while True:
        x += 1
        if x:
            wait
            return
behavior Idles():
    return
    wait
behavior Never():
#        ^^^^^ SC305 the behavior `Never` never takes an action
    print(3)
    def helper(): pass
behavior Once():
    try:
        do Idles()
    interrupt when True:
        abort
        print(3)
        #^^^^^^^ SC303
behavior Interrupted(x):
    while True:
        try:
            take x
        interrupt when x:
            abort
behavior Waits(x):
    while True:
        wait until x
scenario Composed():
    compose:
        print(3)
        #^^^^^^^ SC305 the compose block of the scenario `Composed`
monitor Watches(x):
    while True:
    #^^^^^^^^^^ SC304
        require x > 3
print(function, generator, loops, falls_through, caught)
require monitor Watches(3)
