"""What this module is about,
in several lines.

import math
LONG = """a text
of two lines
SHORT = 'a
def area(radius):
    """The area of a circle.
    return math.pi * radius ** 2 2

class Disc:
    """Fine."""
    radius: 3 4
    name: f"disc {self.radius"
last = 8
