behavior B():
    precondition: self.x = 3
    wait
