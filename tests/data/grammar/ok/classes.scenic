class A:
    x: 3
    y[additive, dynamic, final]: self.x + 1
    match: 3
    front: new Object at 3
    z = 4
    def f(self, a: int = 3, /, *b: str, c, **d) -> int: return self.x
    @property
    def g(self): pass
    if x:
        w: int
class B(A, metaclass=M): x: 3
class C(): pass
