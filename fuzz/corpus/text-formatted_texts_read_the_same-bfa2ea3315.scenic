behavior B():
    precondition: x; y: 3
    wait
