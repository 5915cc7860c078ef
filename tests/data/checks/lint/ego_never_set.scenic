x = new Object
require (distance to x) > 3
#        ^^^^^^^^^^^^^ SC209 `distance` refers to the ego, which is never set
require (distance from x to x) > 3
