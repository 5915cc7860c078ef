monitor Watch():
    wait
behavior Turn(speed=1):
    take speed
behavior Drive():
    do Turn(2)
    do Turn
#      ^^^^ SC314 this names the behavior `Turn`, and makes none
    do Watch()
#      ^^^^^^^ SC314 `do` takes a behavior here, and `Watch` is a monitor
    do choose Turn(1), Inner()
#                      ^^^^^^^ SC314 `do` takes a behavior here, and `Inner` is a scenario
    do shuffle {Turn(1): 2, Watch(): 3}
#                           ^^^^^^^ SC314 `do` takes a behavior here, and `Watch` is a monitor
monitor Follow():
    do Watch()
    do Inner()
#      ^^^^^^^ SC314 `do` takes a behavior here, and `Inner` is a scenario
scenario Inner():
    setup:
        require monitor Watch()
        require monitor Watch
#                       ^^^^^ SC314 this names the monitor `Watch`, and makes none
        require monitor Turn()
#                       ^^^^^^ SC314 `require monitor` takes a monitor here, and `Turn` is a behavior
scenario Main():
    setup:
        ego = new Object with behavior Drive
        a = new Object with behavior Turn(3)
        b = new Object with behavior Watch()
#                                    ^^^^^^^ SC314 `with behavior` takes a behavior here, and `Watch` is a monitor
        c = new Object with behavior Inner
#                                    ^^^^^ SC314 `with behavior` takes a behavior here, and `Inner` is a scenario
        d = new Object with behaviour Turn
#                           ^^^^^^^^^ SC300 `Object` has no property `behaviour`, so `with` creates it
    compose:
        do Inner()
        do Inner
#          ^^^^^ SC314 this names the scenario `Inner`, and makes none
        do Turn()
#          ^^^^^^ SC314 `do` takes a scenario here, and `Turn` is a behavior
        chosen = Inner()
        do chosen
require monitor Watch()
require monitor Follow()
