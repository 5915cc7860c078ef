new C
new C with width 3, at (1, 2), in r, contained in r, on floor
new C offset by 1 @ 2, offset along d by 1 @ 2
new C beyond a by 3, beyond a by 3 from b
new C visible, visible from a, not visible, not visible from a
new C left of a, right of a by 1, ahead of a by 1, behind a, behind a by 2
new C above a, above a by 1, below a, below a by 2
new C following f for 3, following f from a for 3
new C facing 30 deg, facing toward a, facing away from a
new C facing directly toward a, facing directly away from a
new C apparently facing 3, apparently facing 3 from a
new C facing toward, facing away, facing directly
a = b = new C,
    at 3,
    with x 3, with y 4,
    facing 2
new C at 1,
    facing 3,
ego = new C with behavior B(1, x=2), on floor,
    with left 3
if x:
    new C,
        at 3
else: new C at 4
override a with x 3, facing 4
override a.b(1)[2] with x 3,
    facing 4
