import os
#      ^^ SC206
def before(): pass
from furniture import *
def after(): pass
before(3)
after(3)
#     ^ SC211
new Chair with heading 3
print(unknown)
new Object at unknown, facing Range(0, 360)
