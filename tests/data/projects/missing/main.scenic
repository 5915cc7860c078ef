model besides
#     ^^^^^^^ SC406 there is no world model `besides`
from lib.helprs import *
#    ^^^^^^^^^^ SC406 there is no module `lib.helprs`
import lib.nothing_like_it
#      ^^^^^^^^^^^^^^^^^^^ SC406 there is no module `lib.nothing_like_it`
from .nearby import x
#     ^^^^^^ SC406 there is no module `.nearby`
import maht
#      ^^^^ SC406 there is no module `maht`
import some_library_that_nobody_has
#      ^^^^^^^^^^^^^^^^^^^^^^^^^^^^ SC406
from lib import helpers, hepers
#                        ^^^^^^ SC212 the module `lib` has no `hepers`
import scenic.simulators.carl.model
#      ^^^^^^^^^^^^^^^^^^^^^^^^^^^^ SC406
ego = new Unknown left of undefined
print(x, maht, some_library_that_nobody_has, helpers, hepers, lib, scenic)
