ego = new Object
workspace = Workspace(everywhere)
ego.tag = 1
ego, x = 1, 2
#^^ SC200 `ego` can only be set by `ego = value`
a = ego = 3
#   ^^^ SC200
ego += 1
#^^ SC200
workspace: int = 3
#^^^^^^^^ SC200
del ego
#   ^^^ SC200
for ego in [1]: pass
#   ^^^ SC200
[ego for ego in [1]]
#        ^^^ SC200
print(workspace := 3)
#     ^^^^^^^^^ SC200
with open("f") as ego: pass
#                 ^^^ SC200
import os as ego
#            ^^^ SC200
from os import path as str, sep
#                      ^^^ SC200 `str` is the conversion function
def int(float, *, workspace=1): pass
#   ^^^ SC200
#       ^^^^^ SC200
#                 ^^^^^^^^^ SC200
class globalParameters: pass
#     ^^^^^^^^^^^^^^^^ SC200 `globalParameters` cannot be bound
try: pass
except ValueError as ego: pass
#                    ^^^ SC200
lambda str: str
#      ^^^ SC200
behavior ego(workspace):
#        ^^^ SC200
#            ^^^^^^^^^ SC200
    wait
match a:
    case [ego, *str]: pass
    #     ^^^ SC200
    #           ^^^ SC200
def f():
    ego = new Object
    return ego
