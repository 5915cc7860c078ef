"""World model of Webots. Sampling needs no Webots; simulations run in the controller of a supervisor (`WebotsSimulator`)."""

import math
import pickle

import numpy
import trimesh
from scenic.core.object_types import Object2D
from scenic.core.type_support import toScalar, toVector
from scenic.domains.driving.setting import is2DMode
from scenic.simulators.actions import Action
from scenic.simulators.webots import axes as utils
from scenic.simulators.webots.actions import ApplyForceAction, OffsetAction, WriteFileAction
from scenic.simulators.webots.simulator import OutsideWebots
from scenic.simulators.webots.terrain import ground_shape, heights_of, hill_heights

simulator OutsideWebots()

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

class Terrain:
    """A part of an uneven ground, which adds its heights to those of the others.

    It has a place and a size like any object, and has to be inside the workspace. It is neither drawn nor written to worlds, and
    neither collides nor hides anything: the `Ground` has its shape.
    """
    allowCollisions: True
    occluding: False
    requireVisible: False
    render: False

    def heightAt(self, point):
        """The height (metres) at a point of the ground."""
        raise NotImplementedError(f'{type(self).__name__} has no method heightAt(point)')

    def heightsAt(self, across, along):
        """Rows of heights (metres) at the points of a grid: one row for each y in `along`, with its points at the x in `across`."""
        return tuple(tuple(self.heightAt((x, y)) for x in across) for y in along)

class Hill(Terrain):
    """A hill with the profile of a Gaussian; `spread` is the standard deviation as a share of its size."""
    width: 1
    length: 1
    height: 1
    spread: 0.25

    def heightAt(self, point):
        """The height (metres) at a point of the ground."""
        return self.heightsAt((point[0],), (point[1],))[0][0]

    def heightsAt(self, across, along):
        size = (self.width, self.length, self.height)
        return hill_heights(across, along, self.position, self.heading, size, self.spread)

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
    shape: BoxShape() if is2DMode() else ground_shape(self.heights, self.width, self.length, self.baseThickness)
    positionOffset: (-self.width / 2, -self.length / 2, self.baseThickness - self.height / 2)
