# Each car near the one before it.
workspace = Workspace(RectangularRegion((0, 0), 0, 100, 100))
cars = [new Object in workspace, with width 2, with length 4.5 for i in range(4)]
for one, other in zip(cars, cars[1:]):
    require (distance from one to other) < 9
