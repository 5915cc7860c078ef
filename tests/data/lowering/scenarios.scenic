top = 1
scenario Main(count, size=2, *rest):
    """Some boxes."""
    setup:
        import os.path, sys as system
        from math import pi
        total = 0
        def add(amount):
            nonlocal total
            local = amount
            total += local + count
            return lambda: total + size
        class Box:
            width: size
            depth = total
        for i in range(count):
            last = new Box at (i, 0)
        size = [size for count in range(3) if (even := count % 2) == 0]
        with open(system.argv[0]) as handle:
            first, *others = handle
        unset: int
        other: int = 3
        try:
            del first
        except OSError as problem:
            print(problem)
        match others:
            case [one, *more] if one > 2:
                print(one, more)
            case {"k": value, **everything}:
                pass
            case _:
                pass
        global top
        top = total
        ego = last
        behavior Go():
            wait
        require total + count > top
scenario Small:
    new Object
    scenario Inner(a):
        b = a
scenario Outer(p):
    shared = p
    def f():
        scenario Inner(q):
            own = shared + q
            (late := own)
            import os
        return Inner
