class Base:
    kind: "base"
    allowed: True

class Sized(Base):
    """A thing with a size.

    The other dimensions follow from it.
    """
    size: Range(1, 3)
    width: self.size
    length: self.size * 2
    height: self.size / 2

    limit = 10
    names = ["one", "two", "three"]

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.count = 0

    def grow(self, amount=1):
        self.count += amount
        if self.count > self.limit:
            self.count = self.limit
            return False
        return True

    @staticmethod
    def pick(index):
        return Sized.names[index]

    @classmethod
    def make(cls, *sizes):
        return [cls() for size in sizes]

class Coloured(Sized):
    colour: Uniform("red", "green")
    shade[final]: 0.5
    tags[additive]: ("coloured",)
    mixed[additive]: ()

    class Inner:
        value = 3

        def double(self):
            return self.value * 2

    if True:
        extra = 1
    else:
        extra = 2

class Empty:
    pass

class Plain(dict):
    def get_all(self, *keys, default=None):
        return [self.get(key, default) for key in keys]

def build(count):
    made = []
    while len(made) < count:
        thing = new Coloured at (len(made) * 7, 0, 0)
        made.append(thing)
    return made

ego = new Sized at (0, 10, 0), with size 2
things = build(4)
empty = new Empty at (0, 30, 0)
plain = Plain(a=1, b=2)
values = plain.get_all("a", "b", default=0)
total = things[0].limit + things[1].limit
assert total == 20
print(Sized.pick(1), values, total, sep=", ")
require ego.size > 1
require things[0].colour == "red" or things[1].colour == "red"
