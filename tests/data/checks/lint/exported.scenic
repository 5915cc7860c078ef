import os
import sys
#      ^^^ SC206
__all__ = ["os"]
new Object
