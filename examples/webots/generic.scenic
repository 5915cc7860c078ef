"""Crates on a floor: one is in the world already, the others are made when the simulation begins."""

model scenic.simulators.webots.model

floor = RectangularRegion((0, 0, 0), 0, 6, 6)

class Crate(WebotsObject):
    """Is made in the world, and removed at the end."""
    webotsAdhoc: {'physics': True}
    width: Range(0.3, 0.6)
    length: self.width
    height: Range(0.2, 0.5)
    density: 150
    color: (0.7, 0.5, 0.3)

behavior Push():
    """Push the crate to the north, for as long as it takes."""
    while self.position.y < 2:
        take ApplyForceAction((0, 60, 0))

ego = new WebotsObject at (Range(-1, 1), -2, 0.2), with webotsName 'CRATE', with density 150, with width 0.4, with length 0.4, with height 0.4,
    with behavior Push()
below = new Crate on floor
new Crate on below.topSurface
new Crate on floor, facing Range(0, 90) deg

require eventually ego.position.y > 1
terminate after 10 seconds
