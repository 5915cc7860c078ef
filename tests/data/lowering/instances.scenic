workspace = Workspace(RectangularRegion((0, 0), 0, 10, 10))
floor = workspace
ego = new Object at (Range(0, 10), 0, 0), facing 30 deg
box = new Object left of ego by Range(1, 4),
    with width Uniform(1, 2),
    with requireVisible False
chair = new Object on floor
new Object beyond ego by 3, facing toward box
new Object
pair = (new Point at 1 @ 2, new OrientedPoint at ego offset by (1, 2, 3), facing ego)
apart = distance from ego to box
near = distance to box
corner = top front left of ego
when = initial scenario
number = int(apart) + float("3") + len(str(near)) + int("ff", base=16)
