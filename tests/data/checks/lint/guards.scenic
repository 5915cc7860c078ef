behavior Follow(leader):
    precondtion: leader is not self
    #^^^^^^^^^^ SC310 `precondtion` is annotated here and guards nothing
    Invariant: self.speed < 3
    #^^^^^^^^ SC310
    while True:
        take 1
behavior Uses():
    invariants: int
    invariants = 3
    variant: int = 3
    take invariants, variant
behavior Other():
    preference: int
    if self.speed:
        invarant: str
    wait
scenario Main():
    invarient: 1 < 2
    #^^^^^^^^ SC310
    new Object
def function():
    invarient: int
    return 1
precondtion: int
