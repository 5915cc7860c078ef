"""World model of Webots. Sampling needs no Webots; simulations run in the controller of a supervisor (`WebotsSimulator`)."""

from scenic.domains.driving.setting import is2DMode
from scenic.simulators.webots.actions import ApplyForceAction, OffsetAction, WriteFileAction
from scenic.simulators.webots.simulator import OutsideWebots
from scenic.simulators.webots.terrain import ground_solid, heights_of, hill_height

simulator OutsideWebots()

random_height = distributionFunction(hill_height)

if is2DMode():
    class Elevated:
        """The height of an object of the plane, which the simulation tells."""
        elevation[dynamic]: None
else:
    class Elevated:
        """The height of an object is that of its position: set its z."""
        elevation[dynamic, final]: self.position.z

class WebotsObject(Elevated):
    """An object of a Webots world: a node that is there already (`webotsName`, `webotsType`), or is made (`webotsAdhoc`)."""
    requireVisible: False
    webotsAdhoc: None
    webotsName: None
    webotsType: None
    webotsProto: None
    webotsObject: None
    controller: None
    customData: None
    battery[dynamic]: None
    resetController: True
    positionOffset: (0, 0, 0)
    rotationOffset: (0, 0, 0)
    density: None

class Terrain(OrientedPoint):
    """A part of an uneven ground; its heights are added to those of the others."""
    width: 1
    length: 1

    def heightAt(self, point):
        """The height (metres) at a point of the ground."""
        raise NotImplementedError(f'{type(self).__name__} has no method heightAt(point)')

class Hill(Terrain):
    """A hill with the profile of a Gaussian; `spread` is the standard deviation as a share of its size."""
    height: 1
    spread: 0.25

    def heightAt(self, point):
        place = self.position
        dx, dy = point[0] - place.x, point[1] - place.y
        turn = self.heading
        x, y = dx * cos(turn) + dy * sin(turn), dy * cos(turn) - dx * sin(turn)
        return random_height(x, y, self.width, self.length, self.height, self.spread)

class Ground(WebotsObject):
    """The ground: an `ElevationGrid`, flat unless there is terrain."""
    allowCollisions: True
    webotsName: 'GROUND'
    width: 10
    length: 10
    gridSize: 20
    gridSizeX: self.gridSize
    gridSizeY: self.gridSize
    baseThickness: 0.1
    terrain: ()
    heights: heights_of(self.terrain, self.width, self.length, self.gridSizeX, self.gridSizeY)
    shape: BoxShape() if is2DMode() else MeshShape(ground_solid(self.heights, self.width, self.length, self.baseThickness))
    positionOffset: (-self.width / 2, -self.length / 2, self.baseThickness - self.height / 2)
