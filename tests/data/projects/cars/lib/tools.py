"""Tools in Python."""

import functools


class Base:
    def __init__(self, force):
        self.force = force


class Brake(Base):
    """Inherits how it is made."""


class Steer(Base):
    def __init__(self, angle, *, rate=1):
        super().__init__(angle)


class Unknown(functools.partial):
    """Its base is known, and how that is made is not."""


@functools.cache
def cached():
    return 1


def plain(a, b=2, *rest):
    return a
