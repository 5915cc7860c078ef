"""Others may import from here what is not used here."""
import math
import random as chance
from os import path
class Box:
    width: 3
def area():
    import os
#          ^^ SC206 `os` is imported and never used
    return 3
