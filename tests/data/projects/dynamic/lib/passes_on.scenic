from lib.reflective import *
own = 1
