"""Simulations in MuJoCo: rigid bodies with mass, contacts and friction; robots on wheels, grippers, quadrotors.

A program takes the names from here (``from scenic.simulators.mujoco import *``), or says ``model scenic.simulators.mujoco.model``.
"""

from scenic.simulators.commands import (
    Fly,
    SetAcceleration,
    SetSteering,
    SetThrottle,
    SetVelocity,
    SetWheelSpeeds,
)
from scenic.simulators.mujoco.actions import (
    ApplyForce,
    Grasp,
    MoveTo,
    Release,
    SetGripper,
    SetJointPositions,
    SetJointTorques,
    SetJointVelocities,
)
from scenic.simulators.mujoco.simulation import MujocoSimulation
from scenic.simulators.mujoco.simulator import MujocoSimulator

__all__ = [
    "ApplyForce",
    "Fly",
    "Grasp",
    "MoveTo",
    "MujocoSimulation",
    "MujocoSimulator",
    "Release",
    "SetAcceleration",
    "SetGripper",
    "SetJointPositions",
    "SetJointTorques",
    "SetJointVelocities",
    "SetSteering",
    "SetThrottle",
    "SetVelocity",
    "SetWheelSpeeds",
]
