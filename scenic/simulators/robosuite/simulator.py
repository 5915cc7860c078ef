"""Simulations of scenes in robosuite, whose controllers move the robots."""

import math
import time
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.language.errors import ScenicValueError, SimulationCreationError
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.values import Orientation, Vector
from scenic.simulators.cameras import Cameras
from scenic.simulators.robosuite.bodies import (
    arena,
    base_pose,
    body,
    body_pose,
    middle,
    placed_statically,
)
from scenic.simulators.robosuite.library import environment_class, library
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator

__all__ = ["RobosuiteSimulation", "RobosuiteSimulator"]

Floats = NDArray[np.float64]

_HORIZON: Final = 10**9
"""Steps after which robosuite would end an episode: the program decides that."""


class RobosuiteSimulator(Simulator):
    """Runs scenes in robosuite.

    Args:
        use_environment: name of an environment of robosuite whose task is used; its own objects then have the poses of the scene's
            objects of the same names. ``None`` builds the scene's objects.
        camera_view: name of the camera of the window.
        render: whether to show a window.
        real_time: whether a step takes as long as it simulates, at least.
        timestep: seconds in a step, of which a controller has one input.

    """

    def __init__(
        self,
        use_environment: str | None = None,
        camera_view: str | None = None,
        render: bool = False,
        real_time: bool = False,
        timestep: float = 0.05,
    ) -> None:
        super().__init__()
        if not 0 < timestep < math.inf:
            raise ScenicValueError(f"timestep must be a positive number of seconds, not {timestep!r}")
        self.use_environment = use_environment
        self.camera_view = camera_view
        self.render = render
        self.real_time = real_time
        self.timestep = timestep

    def createSimulation(
        self, scene: Scene, *, timestep: float | None = None, **options: Any
    ) -> "RobosuiteSimulation":
        """Return a simulation that has run."""
        step = self.timestep if timestep is None else timestep
        return RobosuiteSimulation(scene, self, timestep=step, **options)


class RobosuiteSimulation(Simulation):
    """One run in robosuite.

    Attributes:
        env: robosuite's environment, once the scene is set up.
        observations: robosuite's observations after the last step, by name.

    """

    def __init__(self, scene: Scene, settings: RobosuiteSimulator, **options: Any) -> None:
        self._settings = settings
        self._robots: list[Any] = []
        self._tables: list[Any] = []
        self._bodies: dict[int, tuple[Any, Any, Floats]] = {}
        """Objects, their bodies in robosuite, and the middles of these, by the objects' identities."""
        self._controls: dict[int, dict[str, Sequence[float]]] = {}
        self._cameras = Cameras()
        self.env: Any = None
        self.observations: Mapping[str, Any] = {}
        super().__init__(scene, **options)

    # Set-up

    def setup(self) -> None:
        """Make the environment with all objects of the scene."""
        super().setup()
        if not self._robots:
            raise SimulationCreationError(
                "robosuite needs a robot", help="put one into the scene, such as `new Panda`"
            )
        robosuite = library()
        arguments = {
            "robots": [robot.robot_type for robot in self._robots],
            "controller_configs": [_controller(robot) for robot in self._robots],
            "gripper_types": [robot.gripper_type for robot in self._robots],
            "base_types": [robot.base_type for robot in self._robots],
            "initialization_noise": None,
            "has_renderer": self._settings.render,
            "has_offscreen_renderer": False,
            "use_camera_obs": False,
            "render_camera": self._settings.camera_view,
            "control_freq": 1 / self.timestep,
            "horizon": _HORIZON,
            "ignore_done": True,
        }
        configs = [_own_config(robot) for robot in self._robots]
        if self._settings.use_environment is None:
            self.env = environment_class()(
                build=self._build, place=self._place, robot_configs=configs, **arguments
            )
        else:
            del arguments["base_types"]
            self.env = _environment(robosuite, self._settings.use_environment, arguments)
        self.observations = self.env.reset()
        if self._settings.use_environment is not None:
            self._place_in_task()

    def createObjectInSimulator(self, obj: Any) -> None:
        """Note the object: robosuite's model is made once, of all objects."""
        if self.env is not None:
            raise SimulationCreationError(
                "robosuite cannot add objects to a simulation that runs", help="create them in the scene"
            )
        if getattr(obj, "robot_type", None) is not None:
            self._robots.append(obj)
        elif getattr(obj, "arena", None) is not None:
            self._tables.append(obj)
        elif self._settings.use_environment is None:
            model = body(obj, f"{type(obj).__name__}_{len(self._bodies)}")
            offset = middle(model)
            self._bodies[id(obj)] = (obj, model, offset)
            if obj.dynamics == "static":
                placed_statically(model, *body_pose(obj, offset))

    def _build(self, robots: list[Any]) -> tuple[Any, list[Any]]:
        """Place robosuite's models of robots; returns arena and objects."""
        for thing, model in zip(self._robots, robots, strict=True):
            position, turn = base_pose(thing)
            model.set_base_xpos(position)
            model._elements["root_body"].set("quat", " ".join(map(repr, turn.tolist())))
        return arena(self._tables), [made for _, made, _ in self._bodies.values()]

    def _place(self, env: Any) -> None:
        """Give all objects that move their poses, whenever the environment is reset."""
        for thing, made, offset in self._bodies.values():
            if made.joints and thing.dynamics != "static":
                env.sim.data.set_joint_qpos(made.joints[0], np.concatenate(body_pose(thing, offset)))
        env.sim.forward()

    def _place_in_task(self) -> None:
        """Give objects of robosuite's own task the poses of the objects of the same names."""
        from robosuite.models.objects import MujocoObject

        models = {
            model.name: model for model in self.env.model.mujoco_objects if isinstance(model, MujocoObject)
        }
        originals = self._original.objects
        for number, thing in enumerate(self.objects):
            if thing in self._robots or thing in self._tables:
                continue
            name = self._original.names.get(originals[number])
            model = models.get(str(name))
            if model is None:
                raise SimulationCreationError(
                    f"the environment {self._settings.use_environment!r} of robosuite has no object {name!r}",
                    help=f"name variables after its objects: {', '.join(models) or 'it has none'}",
                )
            offset = middle(model)
            self._bodies[id(thing)] = (thing, model, offset)
        self._place(self.env)
        self.observations = self.env._get_observations(force_update=True)

    # Steps

    def control(self, agent: object, parts: Mapping[str, Sequence[float]]) -> None:
        """Set inputs of a robot's controllers for the next step; grippers keep theirs."""
        ranges = self._robot(agent)._action_split_indexes
        for part, values in parts.items():
            size = ranges[part][1] - ranges[part][0] if part in ranges else 0
            if len(values) != size:
                raise ScenicValueError(
                    f"the part {part!r} of {agent!r} takes {size} numbers, not {len(values)}",
                    help=f"its parts are {', '.join(f'{name} ({end - start})' for name, (start, end) in ranges.items())}",
                )
        self._controls.setdefault(id(agent), {}).update(parts)

    def _robot(self, thing: object) -> Any:
        return self.env.robots[next(i for i, robot in enumerate(self._robots) if robot is thing)]

    def step(self) -> None:
        """Let controllers and physics run for one step."""
        start_time = time.monotonic()
        action = [
            robot.create_action_vector(
                {part: np.array(values) for part, values in self._controls.get(id(thing), {}).items()}
            )
            for thing, robot in zip(self._robots, self.env.robots, strict=True)
        ]
        self.observations, *_ = self.env.step(np.concatenate(action))
        for parts in self._controls.values():
            for part in [part for part in parts if not part.endswith("gripper")]:
                del parts[part]
        if self._settings.render:
            self.env.render()
        if self._settings.real_time:
            time.sleep(max(0.0, float(self.timestep) - (time.monotonic() - start_time)))

    def sense(self) -> None:
        """Let cameras see."""
        self._cameras.deliver(self)
        super().sense()

    def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
        """Read the state of an object."""
        stored = obj.__dict__
        values = self._robot_properties(obj) if obj in self._robots else self._body_properties(obj)
        return {name: values[name] if name in values else stored[name] for name in properties}

    def _robot_properties(self, obj: object) -> dict[str, Any]:
        robot = self._robot(obj)
        arm = robot.arms[0]
        grip = robot._ref_gripper_joint_pos_indexes.get(arm) if robot.has_gripper[arm] else None
        data = robot.sim.data
        return {
            "joint_positions": tuple(map(float, robot._joint_positions)),
            "gripper_positions": () if grip is None else tuple(map(float, data.qpos[grip])),
            "hand_position": Vector.of(tuple(data.site_xpos[robot.eef_site_id[arm]].tolist())),
        }

    def _body_properties(self, obj: Any) -> dict[str, Any]:
        if id(obj) not in self._bodies or obj.dynamics == "static":
            return {}
        _, model, offset = self._bodies[id(obj)]
        data = self.env.sim.data
        number = self.env.sim.model.body_name2id(model.root_body)
        w, x, y, z = data.body_xquat[number].tolist()
        matrix = data.body_xmat[number].reshape(3, 3)
        local = obj.parentOrientation.inverse * Orientation.of((x, y, z, w))
        yaw, pitch, roll = local.eulerAngles
        velocity, turning = (
            data.get_joint_qvel(model.joints[0])[:3],
            matrix @ data.get_joint_qvel(model.joints[0])[3:],
        )
        velocity = velocity + np.cross(turning, matrix @ offset)
        return {
            "position": Vector.of(tuple((data.body_xpos[number] + matrix @ offset).tolist())),
            "yaw": yaw,
            "pitch": pitch,
            "roll": roll,
            "velocity": Vector.of(tuple(velocity.tolist())),
            "speed": float(np.linalg.norm(velocity)),
            "angularVelocity": Vector.of(tuple(turning.tolist())),
            "angularSpeed": float(np.linalg.norm(turning)),
        }

    def destroy(self) -> None:
        """Close the environment."""
        if self.env is not None:
            self.env.close()
            self.env = None


def _controller(robot: Any) -> Any:
    """Return the configuration of a robot's controllers: its own, or one that is named or given for its arms."""
    configuration = robot.controller_config
    if configuration is None:
        return None
    library()
    from robosuite.controllers import load_composite_controller_config, load_part_controller_config
    from robosuite.controllers.composite.composite_controller_factory import (
        refactor_composite_controller_config,
    )
    from robosuite.models.robots.robot_model import REGISTERED_ROBOTS

    arms = REGISTERED_ROBOTS[robot.robot_type].arms
    try:
        if isinstance(configuration, str):
            parts = (
                "JOINT_POSITION",
                "JOINT_VELOCITY",
                "JOINT_TORQUE",
                "OSC_POSITION",
                "OSC_POSE",
                "IK_POSE",
            )
            if configuration not in parts:
                return load_composite_controller_config(controller=configuration)
            configuration = load_part_controller_config(default_controller=configuration)
        return refactor_composite_controller_config(dict(configuration), robot.robot_type, list(arms))
    except Exception as error:
        raise SimulationCreationError(
            f"robosuite has no controllers {robot.controller_config!r}: {error}",
            help="name one, such as 'JOINT_POSITION', 'OSC_POSE' or 'BASIC', or give a dictionary",
        ) from error


def _own_config(robot: Any) -> dict[str, Any]:
    return (
        {} if robot.initial_qpos is None else {"initial_qpos": [float(value) for value in robot.initial_qpos]}
    )


def _environment(robosuite: Any, name: str, settings: dict[str, Any]) -> Any:
    from scenic.language.spelling import nearest

    names = list(robosuite.ALL_ENVIRONMENTS)
    if name not in names:
        similar_name = nearest(name, names)
        raise SimulationCreationError(
            f"robosuite has no environment {name!r}",
            help=f"did you mean {similar_name!r}?"
            if similar_name
            else f"its environments are {', '.join(names)}",
        )
    return robosuite.make(name, **settings)
