"""Scenarios as environments of Gymnasium (extra ``gym``): `reset` samples a scene, `step` takes an agent's actions and advances.

```python
from scenic.gym import Continuous, ScenicEnv
from scenic.simulators.mujoco import SetWheelSpeeds

env = ScenicEnv(
    "examples/indoor/robot_vacuum.scenic",
    actions=Continuous(SetWheelSpeeds, low=(-0.5, -0.5), high=(0.5, 0.5)),
    observations={"ego": ["position", "yaw", "speed"]},
    reward=lambda now: now.agent.speed,
)
```
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final, SupportsFloat, TypeAlias

import numpy as np

from scenic.dataclass import dataclass
from scenic.formats.mesh_instances import picture
from scenic.formats.render import render
from scenic.language.errors import (
    GuardViolation,
    InvalidScenarioError,
    RejectionException,
    RejectSimulationException,
    UnsupportedError,
)
from scenic.language.extras import installation
from scenic.pipeline import load
from scenic.runtime.elements.sensors import CameraSensor
from scenic.runtime.ground.arguments import check_seconds, whole_number
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.values.values import Orientation, Vector, is_number
from scenic.simulators.cameras import Present
from scenic.simulators.numbered_simulations import choose_simulator
from scenic.simulators.results import TerminationType
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator

try:
    import gymnasium
    from gymnasium import spaces
    from gymnasium.vector import AsyncVectorEnv
except ImportError as error:
    raise UnsupportedError(
        "environments need the package gymnasium", help=f"install it: {installation('gym')}"
    ) from error

__all__ = ["Choice", "Continuous", "Joints", "Moment", "ScenicEnv", "ScenicVectorEnv", "joint_limits"]

Observed: TypeAlias = dict[str, Any]
_Rejected = (RejectSimulationException, RejectionException, GuardViolation)


class Continuous:
    """Actions with numbers between bounds: a ``Box`` of as many dimensions.

    Args:
        make: an action class, or a function that makes an action or several of them; called with one number for each bound.
        low: least values.
        high: greatest values.

    """

    def __init__(self, make: Callable[..., Any], low: Sequence[float], high: Sequence[float]) -> None:
        self.space: spaces.Space[Any] = spaces.Box(
            np.array(low, dtype=np.float32), np.array(high, dtype=np.float32), dtype=np.float32
        )
        self._make = make

    def __call__(self, chosen: object) -> tuple[Any, ...]:
        """The actions for a point of the space."""
        return _several(self._make(*(float(number) for number in np.asarray(chosen))))


class Joints:
    """Actions by joint: a ``Box`` with a number for each joint, in the order of ``limits``.

    Args:
        make: an action class that takes numbers by the names of joints, such as ``SetJointPositions``.
        limits: least and greatest value of each joint by its name; `joint_limits` reads them from a description.

    """

    def __init__(
        self, make: Callable[[Mapping[str, float]], Any], limits: Mapping[str, tuple[float, float]]
    ) -> None:
        low, high = (np.array(ends, dtype=np.float32) for ends in zip(*limits.values(), strict=True))
        self.space: spaces.Space[Any] = spaces.Box(low, high, dtype=np.float32)
        self._names = tuple(limits)
        self._make = make

    def __call__(self, chosen: object) -> tuple[Any, ...]:
        """The action for a point of the space."""
        numbers = (float(number) for number in np.asarray(chosen))
        return _several(self._make(dict(zip(self._names, numbers, strict=True))))


def joint_limits(description: str | Path) -> dict[str, tuple[float, float]]:
    """The limits of all joints of an MJCF or URDF file by name, radians or metres; those without a limit have a turn.

    Raises:
        DescriptionError: the file cannot be read.

    """
    from scenic.simulators.mujoco.robot_descriptions import read_description

    joints = read_description(description).joints
    return {name: (max(joint.low, -math.pi), min(joint.high, math.pi)) for name, joint in joints.items()}


class Choice:
    """One of several actions: a ``Discrete`` space.

    Args:
        options: each an action, or a sequence of actions that are taken together (empty to do nothing).

    """

    def __init__(self, options: Sequence[Any]) -> None:
        self._options = [_several(option) for option in options]
        self.space: spaces.Space[Any] = spaces.Discrete(len(self._options))

    def __call__(self, chosen: Any) -> tuple[Any, ...]:
        """Return the actions of an option."""
        return self._options[int(chosen)]


def _several(actions: object) -> tuple[Any, ...]:
    return tuple(actions) if isinstance(actions, list | tuple) else (actions,)


@dataclass(frozen=True, slots=True)
class Moment:
    """The input of a function for the reward.

    Attributes:
        agent: whose actions are taken, with its properties as they are now.
        objects: by the names of the program's variables, likewise.
        actions: what the agent has just done.
        records: what ``record`` statements have saved so far.
        time: seconds since the simulation began.
        ended: why the simulation ended, or ``None``.

    """

    agent: Any
    objects: Mapping[str, Any]
    actions: tuple[Any, ...]
    records: Mapping[str, Any]
    time: float
    ended: str | None


class ScenicEnv(gymnasium.Env[Observed, Any]):
    """One agent of a scenario in a simulator.

    Episode ``k`` after ``reset(seed=s)`` is simulation ``k`` of the seed ``s``: the same scene and the same draws, whatever came
    before. It is *terminated* when the simulation ends or a requirement rejects it, and *truncated* at ``max_steps``. Behaviors,
    monitors, records and requirements of the program run as in any simulation; the actions come on top of what a behavior of
    the agent does.

    Args:
        scenario: a scenario, or the path of a program.
        actions: what the agent may do: `Continuous`, `Joints` or `Choice`.
        observations: names of properties by the name of the object that has them (``ego``, or a variable of the program); or of
            the agent alone. ``observations.front`` is what its camera ``front`` sees. The space is a ``Dict`` of boxes
            named ``ego.position`` and the like.
        reward: the name of a ``record`` statement, whose latest value counts, or a function of a `Moment`.
        agent: its name.
        simulator: a simulator, or a name as `scenic simulate` takes it; the program's own by default.
        max_steps: steps of an episode.
        timestep: seconds in a step; the simulator's own if ``None``.
        bounds: ``(least, greatest)`` of observations by name, where they are known.
        rejection: the reward of a step in which a requirement rejects the simulation.
        tries: so many scenes and simulations are tried for an episode.
        first: number of the first episode of a seed.
        stride: by how much the numbers of later episodes grow.
        render_mode: ``rgb_array`` for images, or ``None``.
        image_size: columns and rows of those.

    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012 - the interface has it so

    def __init__(
        self,
        scenario: Scenario | str | Path,
        *,
        actions: Continuous | Joints | Choice,
        observations: Mapping[str, Sequence[str]] | Sequence[str],
        reward: str | Callable[[Moment], SupportsFloat],
        agent: str = "ego",
        simulator: Simulator | str | None = None,
        max_steps: int = 200,
        timestep: float | None = None,
        bounds: Mapping[str, tuple[float, float]] | None = None,
        rejection: float = 0.0,
        tries: int = 100,
        first: int = 0,
        stride: int = 1,
        render_mode: str | None = None,
        image_size: tuple[int, int] = (480, 360),
    ) -> None:
        numbers = {"max_steps": max_steps, "tries": tries, "stride": stride}
        numbers |= {"image_size[0]": image_size[0], "image_size[1]": image_size[1]}
        for name, number in numbers.items():
            whole_number(number, name, 1)
        whole_number(first, "first", 0)
        check_seconds(timestep, "timestep")
        self.scenario = scenario if isinstance(scenario, Scenario) else load(scenario)
        if simulator is None or isinstance(simulator, str):
            simulator = choose_simulator(simulator, self.scenario)
        self._simulator = simulator
        self._actions = actions
        self._reward = reward
        self._name = agent
        self._running = {"maxSteps": max_steps, "timestep": timestep}
        self._rejection = rejection
        self._tries = tries
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode must be 'rgb_array' or None, not {render_mode!r}")
        self.render_mode = render_mode
        self._image_size = image_size
        self._seed: int | None = None
        self._first, self._stride = first, stride
        self._k = first
        self._simulation: Simulation | None = None
        self._objects: dict[str, Any] = {}
        self._present: Present | None = None
        names_by_owner = observations if isinstance(observations, Mapping) else {agent: observations}
        self._watched = [(owner, name) for owner, names in names_by_owner.items() for name in names]
        self.action_space = actions.space
        self.observation_space = self._observation_space(bounds or {})

    def _observation_space(self, bounds: Mapping[str, tuple[float, float]]) -> spaces.Dict:
        """The kinds of the observations, read off a scene."""
        scene = self._scene(0, 0)
        objects_by_name = _named(scene.names, scene.objects, scene.egoObject)
        box_of: dict[str, spaces.Space[Any]] = {}
        for owner, name in self._watched:
            if owner not in objects_by_name:
                names = ", ".join(objects_by_name)
                raise InvalidScenarioError(
                    f"the program has no object {owner!r}",
                    help=f"objects go by the names of their variables; here: {names}",
                )
            key = f"{owner}.{name}"
            box_of[key] = _box(objects_by_name[owner], name, bounds.get(key, bounds.get(name)))
        if self._name not in objects_by_name:
            raise InvalidScenarioError(
                f"the program has no agent {self._name!r}",
                help=f"its objects are {', '.join(objects_by_name)}",
            )
        return spaces.Dict(box_of)

    # The interface

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observed, dict[str, Any]]:
        """Begin the next episode.

        Args:
            seed: begin again with the first episode of this seed.
            options: ``{"k": number}`` chooses the episode.

        """
        super().reset(seed=seed)
        self._stop()
        if seed is not None or self._seed is None:
            self._seed = seed if seed is not None else int(self.np_random.integers(2**32))
            self._k = self._first
        if options and "k" in options:
            self._k = whole_number(options["k"], "k", 0)
        why = ""
        for number in range(1, self._tries + 1):
            try:
                going = self._begin(number)
            except _Rejected as error:
                self._stop()
                why = str(error)
                continue
            if going:
                break
            raise InvalidScenarioError(
                "the simulation ends before the agent can act", help="look at its conditions for the end"
            )
        else:
            raise RejectionException(f"simulation {self._k} of seed {self._seed} is always rejected: {why}")
        info = {"seed": self._seed, "k": self._k, "tries": number}
        self._k += self._stride
        return self._observe(), info

    def step(self, action: object) -> tuple[Observed, float, bool, bool, dict[str, Any]]:
        """Take an action and advance by one step."""
        simulation = self._simulation
        if simulation is None:
            raise gymnasium.error.ResetNeeded("call reset() before step()")
        actions = self._actions(action)
        agent = self._objects[self._name]
        simulation.take(agent, actions)
        info: dict[str, Any] = {}
        terminated = truncated = False
        end_reason: str | None = None
        try:
            going = simulation.advanceOnce()
        except _Rejected as error:
            self._stop()
            info["rejected"] = str(error)
            return self._observe(), float(self._rejection), True, False, info
        result = simulation.result
        if not going and result is not None:
            truncated = result.terminationType is TerminationType.timeLimit
            terminated = not truncated
            end_reason = result.terminationReason
            info["reason"] = end_reason
            info["requirements"] = {
                item.label: None if item.verdict is None else item.verdict.name
                for item in result.requirements
            }
        moment = Moment(
            agent, self._objects, actions, simulation.records, simulation.currentRealTime, end_reason
        )
        if not going:
            self._simulation = None
        return self._observe(), self._rewarded(moment), terminated, truncated, info

    def render(self) -> Any:
        """Return an image of what is now, ``(height, width, 3)``, if the environment was made with ``render_mode="rgb_array"``."""
        if self.render_mode is None:
            return None
        if self._present is None:
            raise gymnasium.error.ResetNeeded("call reset() before render()")
        return render(picture([self._present], ground=True), 0, self._image_size)

    def close(self) -> None:
        """End the simulation."""
        self._stop()

    # Episodes

    def _scene(self, seed: int, k: int) -> Any:
        (scene,) = self.scenario.stream(1, seed=seed, first=k)
        if isinstance(scene, Exhausted):
            raise RejectionException(
                f"no scene {k} of seed {seed} was found in {scene.attempts} attempts; "
                "`scenic sample` tells which requirement is to blame"
            )
        return scene

    def _begin(self, number: int) -> bool:
        """Set try ``number`` of the episode up, to where the agent is to act; false if it ends before."""
        assert self._seed is not None
        scene = self._scene(self._seed, self._k)
        key = f"{self._seed}:{self._k}:{number}".encode()
        simulation = self._simulator.createSimulation(
            scene, **self._running, name=str(self._k), key=key, deferred=True, verbosity=0
        )
        self._simulation = simulation
        simulation.begin()
        originals = {id(thing): name for thing, name in scene.names.items()}
        names = {
            copy: originals[id(thing)]
            for copy, thing in zip(simulation.objects, scene.objects, strict=False)
            if id(thing) in originals
        }
        self._objects = _named(names, simulation.objects, simulation.scene.egoObject)
        missing = {owner for owner, _ in self._watched} | {self._name}
        for owner in sorted(missing - self._objects.keys()):
            raise InvalidScenarioError(
                f"{owner!r} takes no part in scene {self._k} of seed {self._seed}",
                help="observe what is in every scene: `present` must be True for it",
            )
        self._present = Present(simulation)
        return simulation.advanceOnce()

    def _stop(self) -> None:
        if self._simulation is not None:
            self._simulation.cancel()
            self._simulation = None

    def _observe(self) -> Observed:
        space = self.observation_space
        assert isinstance(space, spaces.Dict)
        return {
            f"{owner}.{name}": _value(self._objects[owner], name, space[f"{owner}.{name}"])
            for owner, name in self._watched
        }

    def _rewarded(self, moment: Moment) -> float:
        if callable(self._reward):
            return float(self._reward(moment))
        series = moment.records.get(self._reward)
        if series is None:
            known = ", ".join(moment.records) or "none"
            raise InvalidScenarioError(
                f"the program records no {self._reward!r}", help=f"its records are: {known}"
            )
        return float(series[-1][1] if isinstance(series, list) else series)


class ScenicVectorEnv(AsyncVectorEnv):
    """Several environments of a scenario, each in a process of its own.

    The episodes of a seed are dealt out: environment ``i`` of ``n`` plays episodes ``i``, ``i + n``, ``i + 2 n``, ... as a
    `ScenicEnv` plays them, whatever the others do. So a seed, the number of environments and the actions decide everything.

    Args:
        scenario: a scenario, or the path of a program.
        num_envs: how many environments.
        context: how processes are started (``fork``, ``spawn``, ``forkserver``); the system's default if ``None``.
        options: for `ScenicEnv`.

    """

    def __init__(
        self, scenario: Scenario | str | Path, num_envs: int, *, context: str | None = None, **options: Any
    ) -> None:
        whole_number(num_envs, "num_envs", 1)
        makers = [
            partial(ScenicEnv, scenario, first=number, stride=num_envs, **options)
            for number in range(num_envs)
        ]
        super().__init__(makers, context=context)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin the next episode in every environment; a seed is that of all of them, of which each has episodes of its own."""
        seeds: list[int | None] | None = [seed] * self.num_envs if isinstance(seed, int) else seed
        return super().reset(seed=seeds, options=options)


_ANGLES: Final = ("yaw", "pitch", "roll", "heading")


def _named(names: Mapping[Any, str], objects: Iterable[Any], ego: object) -> dict[str, Any]:
    """Objects by name; the ego has its own besides."""
    found = {} if ego is None else {"ego": ego}
    known = {id(thing): name for thing, name in names.items()}
    for thing in objects:
        if id(thing) in known:
            found.setdefault(known[id(thing)], thing)
    return found


def _box(thing: object, name: str, bounds: tuple[float, float] | None) -> spaces.Space[Any]:
    """Return the space of a property, by its value in a scene."""
    if name.startswith("observations."):
        return _image_space(thing, name.partition(".")[2], bounds)
    try:
        value = getattr(thing, name)
    except AttributeError:
        raise InvalidScenarioError(
            f"{thing!r} has no property {name!r}", help="observe properties, or `observations.CAMERA`"
        ) from None
    low, high = (-math.inf, math.inf) if bounds is None else bounds
    if isinstance(value, bool):
        return spaces.Box(0, 1, (1,), np.float64)
    if bounds is None and name in _ANGLES:
        low, high = -math.pi, math.pi
    if isinstance(value, Orientation) and bounds is None:
        low, high = -1.0, 1.0
    count = len(_numbers(thing, name, value))
    return spaces.Box(low, high, (count,), np.float64)


def _image_space(thing: Any, camera: str, bounds: tuple[float, float] | None) -> spaces.Space[Any]:
    sensor = thing.sensors.get(camera)
    if not isinstance(sensor, CameraSensor) or len(sensor.outputs) != 1:
        raise InvalidScenarioError(
            f"{thing!r} has no camera {camera!r} for colours or depth",
            help=f"its sensors are: {', '.join(map(str, thing.sensors)) or 'none'}",
        )
    shape = (sensor.height, sensor.width)
    if sensor.outputs == ("rgb",):
        return spaces.Box(0, 255, (*shape, 3), np.uint8)
    low, high = (0, math.inf) if bounds is None else bounds
    return spaces.Box(low, high, shape, np.float32)


def _value(thing: Any, name: str, space: spaces.Space[Any]) -> Any:
    """Return a property as a point of its space, to whose bounds it is clipped."""
    assert isinstance(space, spaces.Box)
    if name.startswith("observations."):
        found = np.asarray(thing.observations[name.partition(".")[2]])
    else:
        found = np.array(_numbers(thing, name, getattr(thing, name)))
    return np.clip(found, space.low, space.high).astype(space.dtype)


def _numbers(thing: object, name: str, value: object) -> list[float]:
    if is_number(value):
        return [float(value)]
    if isinstance(value, Mapping) and value and all(map(is_number, value.values())):  # of joints by name
        return [float(part) for part in value.values()]
    if isinstance(value, Orientation):
        return list(value.q)
    if isinstance(value, Vector | tuple | list) and all(is_number(part) for part in value):
        return [float(part) for part in value]
    raise InvalidScenarioError(
        f"property {name!r} of {thing!r} is {value!r}, which is not a number or several",
        help="observe numbers, vectors and orientations",
    )
