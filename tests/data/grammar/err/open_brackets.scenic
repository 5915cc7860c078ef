LANES = [
    Lane(offset=-2, heading=0),
    Lane(offset=2, heading=180 deg),
SPEED = 12
settings = dict(
    width=Range(1, 2,
    names=["a", "b"],
)
def reach(robot, box:
    while (distance from robot to box < 3:
        box = box.next next
    return box
behavior Wait(
def place(count]:
    return [(0, 0}, (count, 0)]
ego = new Car at (0, 0), with behavior Drive(
other = new Car at (10, 0)
print("done)
table = {
    "a": [1, 2],
    "b": (3, 4],
    "c": 5,
}
last = 8
