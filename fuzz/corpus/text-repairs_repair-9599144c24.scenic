def f(p): x x
