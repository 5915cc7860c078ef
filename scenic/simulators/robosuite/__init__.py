"""Scenes in robosuite: tables, things and arms with robosuite's own controllers.

A program says ``model scenic.simulators.robosuite.model``. Compiling and sampling it does not need robosuite.
"""

from scenic.simulators.robosuite.actions import JointPositionAction, OSCPositionAction, RobotAction
from scenic.simulators.robosuite.simulator import RobosuiteSimulation, RobosuiteSimulator

__all__ = [
    "JointPositionAction",
    "OSCPositionAction",
    "RobosuiteSimulation",
    "RobosuiteSimulator",
    "RobotAction",
]
