# A car that looks ahead, for labelled images (`python -m benchmarks.labels`).

from scenic import RGBSensor

class Car:
    width: 1.8
    length: 4.4
    height: 1.5

class Cone:
    shape: ConeShape()
    width: 0.6
    length: 0.6
    height: 1

class Ball:
    shape: SpheroidShape()
    width: Range(0.5, 2)
    length: self.width
    height: self.width

workspace = Workspace(RectangularRegion((0, 15, 0), 0, 30, 50))
floor = RectangularRegion((0, 15, 0), 0, 30, 50)
camera = RGBSensor(offset=(0, 1.2, 0.9), width=320, height=240, attributes={"fov": 80})

ego = new Car at (0, -6, 0.75), with sensors {"front": camera}
for i in range(5):
    new Car on floor, facing Range(0, 360) deg
for i in range(4):
    new Cone on floor
for i in range(3):
    new Ball on floor
