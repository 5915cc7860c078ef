"""Nothing is said about names that may come from what cannot be known."""
from lib.passes_on import *
from lib.lazy import anything
from lib.broken import y
import lib.lazy as lazy
ego = new Anything with whatever 3
print(a, own, anything, lazy.other, y, Range(1))
