# Blocks on top of each other.
LEVELS = 4
SIZES = [1.0, 0.8, 0.6, 0.4]
COLOURS = {
    0: "grey",
    1: "white",
    2: "black",
    3: "gold",
}

class Block(Object):
    size: 1
    width: self.size
    length: self.size
    height: self.size
    colour: "grey"
    density: 1.2 if self.size > 0.5 else 2.4

ground = new Object at (0, 0, -0.5),
    with width 10,
    with length 10,
    with height 1

ego = new Block on ground,
    with size SIZES[0],
    with colour COLOURS[0]
below = ego
tower = [ego]

for level in range(1, LEVELS):
    size = SIZES[level]
    block = new Block on below,
        with size size,
        with colour COLOURS[level],
        facing Range(-10, 10) deg
    if level > 2:
        block.colour = "red"
    elif level == 2:
        block.colour = "pink"
    below = block
    tower.append(block)

heights = [block.height for block in tower]
top = tower[-1]
summit = top.position.z + top.height / 2

behavior Fall(force):
    start = self.position
    while (distance from self to start) < 0.1:
        take ("push", force)
        wait

pusher = new Block at (3, 0, 0.5),
    with behavior Fall(2)
observer = new Object at (5, 5, 2),
    facing directly toward top,
    with viewAngles (60 deg, 40 deg),
    with visibleDistance 20

require sum(heights) < 3
require summit > 1.5
require observer can see top
require (top.heading - ego.heading) < 20 deg
require all(
    upper.size < lower.size
    for lower, upper in zip(tower, tower[1:])
)
record top.position every 1 steps as fall
record final top.position.z as height
terminate when top.position.z < 1
