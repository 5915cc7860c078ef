# Names that are keywords elsewhere.
match = 3
case = [1, 2]
type = "plain"
record = {"final": 1, "initial": 2}
left, right = 1, 2
top = bottom = 0
front = left + right
model = record["final"]
position = (left, right, top)
heading = 30 deg
behind = lambda above: above + 1
steps = 5
seconds = steps * 2
angle = seconds / 4

def relative(offset, visible=False, *, facing=None):
    wait = offset
    if visible:
        wait = wait + 1
    take = [wait, facing]
    return take

class Following(Object):
    distance: 3
    ahead: self.distance * 2
    final: True
    every: "step"

ego = new Following at position,
    facing heading,
    with ahead 4
mutate_count = len(case)
next_one = next(iter(case))
choose = relative(offset=2, visible=True)
shuffle = relative(3, facing=choose)
abort = None if match > 3 else choose
override = {"type": type, "match": match}
precondition = override["match"] == 3
interrupt = behind(below := 4)
print(precondition, interrupt, below)

match match:
    case 3:
        setup = "three"
    case _:
        setup = "other"

behavior Wait(seconds):
    initial = seconds
    while initial > 0:
        initial -= 1
        take ("wait", initial)
    wait

monitor Check():
    simulation = 0
    while simulation < steps:
        simulation += 1
        wait

visible = [1, 2, 3]
first = visible if visible else None
require monitor Check()
require first == 1
require steps < 10 and seconds < 20
require (distance from ego to (0, 0, 0)) < 30
