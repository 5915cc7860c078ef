class Chair:
    width: 3
    height: self.width
    width: 4
    #^^^^ SC210 the property `width` is defined twice
    depth: f(self)
    #        ^^^^ SC200 `self` stands alone in the default of a property
    tags[additive]: [(lambda self: self)(3), self.width]
def f(x): return x
class Stool(Chair):
    seats: 1
class Unknown(f(Chair)): pass
require[1] True
require[0] True
new Chair with widht 3, with depth 3, with dept 3
#              ^^^^^ SC300 `Chair` has no property `widht`
#                                          ^^^^ SC300
new Stool with seat 3, with behaviour None
#              ^^^^ SC300
#                           ^^^^^^^^^ SC300
new Point with witdh 3, with behaviour None
#              ^^^^^ SC300
new Unknown with widht 3
