import math
class Chair:
    """A chair."""
    legs = 4
    width: 0.5
    height: self.width * 2 + self.sizes[self.length]
    def sit(self):
        return ego
    tags[additive]: [i for self in range(3) for i in self.x] + [self.depth]
class Stool(Chair):
    pass
class Plain(Exception):
    pass
class Odd(metaclass=type):
    speed[dynamic]: 3
class Local(Chair, Plain):
    size: lambda x: x + self.width

def decorate(cls):
    return cls
@decorate
class Decorated:
    pass
