class A:
    x: 3
    y: 4 5
    def f(self, a b):
        return 1
    def g(self):
        return 2 3
    z: int = 3
    w[odd]: 3
behavior B(x):
    take 1 2
    precondition: x
    try:
        do A() for 3
    interrupt x:
        abort
    do B() until
    wait
scenario S():
    setup:
        ego = new Object at
    compose:
        do
monitor M:
    wait
behavior C(
