"""Scenarios as environments of Gymnasium."""

import importlib.util
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.language.errors import InvalidScenarioError, RejectionException, UnsupportedError

if importlib.util.find_spec("gymnasium") is None:
    pytest.skip("needs the extra [gym]", allow_module_level=True)

import gymnasium
from gymnasium.utils.env_checker import check_env

from scenic.gym import Choice, Continuous, Joints, Moment, ScenicEnv, ScenicVectorEnv, joint_limits
from scenic.simulators.kinematic import SetVelocity, SetWheelSpeeds
from scenic.simulators.numbered_simulations import choose_simulator, simulate_number

CHASE = """
from scenic.simulators.kinematic import *
behavior Wander():
    while True:
        take SetVelocity((Range(-1, 1), Range(-1, 1), 0))
ego = new Object at (Range(-3, 3), 0), with dynamics 'differential', with width 0.5, facing Range(-30, 30) deg
prey = new Object at (0, Range(4, 9)), with behavior Wander
record -(distance from ego to prey) as reward
terminate when (distance from ego to prey) < 2.5
"""
WHEELS = Continuous(SetWheelSpeeds, (-2, -2), (2, 2))


def environment(text: str = CHASE, **options: Any) -> ScenicEnv:
    given: dict[str, Any] = {
        "actions": WHEELS,
        "observations": {"ego": ["position", "yaw", "speed"], "prey": ["position"]},
        "reward": "reward",
        "max_steps": 50,
        **options,
    }
    return ScenicEnv(scenic.scenarioFromString(text), **given)


def flat(observation: Any) -> list[float]:
    return [float(number) for key in sorted(observation) for number in np.ravel(observation[key])]


@pytest.mark.filterwarnings("ignore::UserWarning:gymnasium.*")
@pytest.mark.parametrize("simulator", ["kinematic", "mujoco"])
def test_gymnasium_accepts_it(simulator: str) -> None:
    if simulator == "mujoco" and importlib.util.find_spec("mujoco") is None:
        pytest.skip("needs the extra [mujoco]")
    text = CHASE.replace("0), with dynamics", "0, 0.5), with dynamics").replace(
        "Range(4, 9))", "Range(4, 9), 0.5)"
    )
    check_env(environment(text, simulator=simulator, render_mode="rgb_array", image_size=(48, 36)))


def test_spaces_come_from_actions_and_properties() -> None:
    env = environment(bounds={"speed": (0, 2)})
    assert env.action_space == gymnasium.spaces.Box(-2, 2, (2,), np.float32)
    observed = env.observation_space
    assert isinstance(observed, gymnasium.spaces.Dict)
    assert list(observed) == ["ego.position", "ego.speed", "ego.yaw", "prey.position"]
    assert observed["ego.position"] == gymnasium.spaces.Box(-np.inf, np.inf, (3,), np.float64)
    assert observed["ego.yaw"] == gymnasium.spaces.Box(-np.pi, np.pi, (1,), np.float64)
    assert observed["ego.speed"] == gymnasium.spaces.Box(0, 2, (1,), np.float64)
    both = {"ego": ["speed", "heading"], "prey": ["speed", "pitch", "roll"]}
    several = environment(observations=both, bounds={"speed": (0, 2), "prey.speed": (1, 3)}).observation_space
    assert isinstance(several, gymnasium.spaces.Dict)
    assert several["ego.speed"] == gymnasium.spaces.Box(0, 2, (1,), np.float64)
    assert several["prey.speed"] == gymnasium.spaces.Box(1, 3, (1,), np.float64)
    for angle in ("ego.heading", "prey.pitch", "prey.roll"):
        assert several[angle] == gymnasium.spaces.Box(-np.pi, np.pi, (1,), np.float64)
    alike = environment(observations=both, bounds={"speed": (0, 2)}).observation_space
    assert isinstance(alike, gymnasium.spaces.Dict)
    assert alike["ego.speed"] == alike["prey.speed"] == several["ego.speed"]
    discrete = environment(actions=Choice([SetWheelSpeeds(1, 1), [], [SetWheelSpeeds(0, 1)]]))
    assert discrete.action_space == gymnasium.spaces.Discrete(3)


def test_episodes_are_the_simulations_of_the_seed() -> None:
    env = environment(observations=["position"])
    scenario = scenic.scenarioFromString(CHASE)
    for k in range(3):
        observation, info = env.reset(seed=4 if k == 0 else None)
        assert (info["k"], info["seed"]) == (k, 4)
        (scene,) = scenario.stream(1, seed=4, first=k)
        assert tuple(observation["ego.position"]) == tuple(scene.egoObject.position)
    again, _ = env.reset(seed=4, options={"k": 2})
    assert flat(again) == flat(observation)


def test_an_agent_that_does_nothing_sees_the_simulation_of_the_command() -> None:
    scenario = scenic.scenarioFromString(CHASE)
    numbered = simulate_number(scenario, choose_simulator("kinematic", scenario), seed=2, k=1, maxSteps=30)
    assert numbered.simulation is not None
    states = numbered.simulation.trajectory
    env = environment(actions=Choice([[]]), max_steps=30)
    observation, _ = env.reset(seed=2, options={"k": 1})
    seen, rewards = [observation["prey.position"]], []
    while True:
        observation, reward, terminated, truncated, _ = env.step(0)
        seen.append(observation["prey.position"])
        rewards.append(reward)
        if terminated or truncated:
            break
    np.testing.assert_array_equal(seen, [tuple(state[1]) for state in states])
    assert rewards == [value for _, value in numbered.simulation.records["reward"]][1:]


def test_actions_move_the_agent_at_once() -> None:
    env = environment(
        "ego = new Object with dynamics 'differential'\nrecord ego.y as reward\n",
        observations=["position", "speed"],
        timestep=0.5,
    )
    observation, _ = env.reset(seed=0)
    assert flat(observation) == [0, 0, 0, 0]
    for number, speed in enumerate((1.0, -1.0, 1.0), 1):
        observation, reward, *_ = env.step(np.array([speed, speed], dtype=np.float32))
        assert observation["ego.position"][1] == pytest.approx(0.5 * (number % 2))
        assert reward == pytest.approx(0.5 * (number % 2))


def test_ends() -> None:
    env = environment(max_steps=3)
    env.reset(seed=1)
    ends = [env.step(np.zeros(2, dtype=np.float32))[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(2, dtype=np.float32))
    near = "ego = new Object\nterminate when ego.y > 0.9\nrequire eventually ego.y > 0.5 as far\nrecord ego.y as reward\n"
    env = environment(near, actions=Choice([SetVelocity((0, 5, 0))]), observations=["position"])
    env.reset(seed=1)
    assert env.step(0)[2:4] == (False, False)
    observation, reward, terminated, truncated, info = env.step(0)
    assert (terminated, truncated, reward) == (True, False, 1)
    assert observation["ego.position"][1] == 1, "what is seen is the end, not the scene"
    assert info["requirements"] == {"far": "TRUE"}


def test_rejected_simulations_end_the_episode() -> None:
    text = "ego = new Object\nrequire always ego.y < 0.9\nrecord 1 as reward\n"
    env = environment(text, actions=Choice([SetVelocity((0, 5, 0))]), observations=["position"], rejection=-7)
    env.reset(seed=1)
    assert env.step(0)[1:4] == (1, False, False)
    _, reward, terminated, truncated, info = env.step(0)
    assert (reward, terminated, truncated) == (-7, True, False)
    assert "rejected" in info
    env.reset()
    assert env.step(0)[1:4] == (1, False, False)


def test_rewards_may_be_functions() -> None:
    moments: list[Moment] = []

    def reward(now: Moment) -> float:
        moments.append(now)
        return -now.agent.position.y + now.objects["prey"].position.x + now.time

    env = environment(reward=reward, max_steps=2)
    env.reset(seed=3)
    for _ in range(2):
        observation, given, *_ = env.step(np.ones(2, dtype=np.float32))
        wanted = -observation["ego.position"][1] + observation["prey.position"][0] + moments[-1].time
        assert given == pytest.approx(wanted)
    assert [now.ended for now in moments] == [None, "reached time limit (2 steps)"]
    assert repr(moments[0].actions) == "(SetWheelSpeeds(1, 1),)"


def test_cameras_are_observed() -> None:
    text = """
from scenic import RGBSensor, DepthSensor
ego = new Object with sensors {'front': RGBSensor(width=16, height=12), 'depth': DepthSensor(width=16, height=12)}
new Object at (0, 4)
record 0 as reward
"""
    env = environment(text, actions=Choice([[]]), observations=["observations.front", "observations.depth"])
    observation, _ = env.reset(seed=0)
    assert observation in env.observation_space
    assert observation["ego.observations.front"].shape == (12, 16, 3)
    assert observation["ego.observations.depth"].min() == pytest.approx(3, abs=1e-5)


def test_depth_is_seen_within_its_bounds() -> None:
    text = (
        "from scenic import DepthSensor\nego = new Object with sensors {'depth': DepthSensor(width=16, height=12)}\n"
        "new Object at (0, 4)\n"
    )
    given: dict[str, Any] = {
        "actions": Choice([[]]),
        "observations": ["observations.depth"],
        "reward": lambda _: 0,
    }
    seen = []
    for bounds in ({}, {"observations.depth": (3.1, 5)}):
        env = environment(text, bounds=bounds, **given)
        low, high = next(iter(bounds.values()), (0, np.inf))
        assert env.observation_space["ego.observations.depth"] == gymnasium.spaces.Box(
            low, high, (12, 16), np.float32
        )
        seen.append(env.reset(seed=0)[0]["ego.observations.depth"])
    np.testing.assert_allclose(seen[1], np.clip(seen[0], np.float32(3.1), 5))
    assert seen[1].dtype == np.float32


@pytest.mark.parametrize(
    ("moment", "rewards"), [("", [1, 2, 3]), ("initial", [0, 0, 0]), ("every 2 steps", [0, 2, 2])]
)
def test_the_latest_value_of_a_record_is_the_reward(moment: str, rewards: list[float]) -> None:
    text = (
        f"ego = new Object\nrecord {moment} simulation().currentTime as reward\n"
        if moment == "initial"
        else (f"ego = new Object\nrecord simulation().currentTime {moment} as reward\n")
    )
    env = environment(text, actions=Choice([[]]), observations=["position"])
    env.reset(seed=0)
    assert [env.step(0)[1] for _ in range(3)] == rewards


def test_render_shows_the_present() -> None:
    env = environment(render_mode="rgb_array", image_size=(40, 30))
    env.reset(seed=0)
    before = env.render()
    assert before.shape == (30, 40, 3)
    env.step(np.array([2, -2], dtype=np.float32))
    assert (env.render() != before).any()
    env.close()


TWO_IMAGES = """
from scenic import SSSensor
ego = new Object with sensors {'front': SSSensor(width=16, height=12)}
"""


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"observations": {"cat": ["position"]}}, "no object 'cat'"),
        ({"observations": ["whiskers"]}, "no property 'whiskers'"),
        ({"observations": ["shape"]}, "not a number"),
        ({"observations": ["observations.front"]}, "no camera 'front'"),
        ({"text": TWO_IMAGES, "observations": ["observations.front"]}, "no camera 'front'"),
        ({"agent": "cat", "observations": {"ego": ["position"]}}, "no agent 'cat'"),
    ],
)
def test_what_is_not_there_is_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidScenarioError, match=message):
        environment(**options)


def test_mistakes_of_a_run_are_told() -> None:
    env = environment(reward="joy")
    env.reset(seed=0)
    with pytest.raises(InvalidScenarioError, match="records no 'joy'"):
        env.step(np.zeros(2, dtype=np.float32))
    env = environment(actions=Choice([SetVelocity((1, 0, 0))]))
    env.reset(seed=0)
    with pytest.raises(InvalidScenarioError, match="cannot take these actions"):
        env.step(0)
    env = environment("ego = new Object\nterminate when True\n", observations=["position"])
    with pytest.raises(InvalidScenarioError, match="ends before the agent can act"):
        env.reset(seed=0)
    guarded = "behavior B():\n    precondition: self.x > 1\n    wait\nego = new Object with behavior B\n"
    env = environment(guarded, observations=["position"], tries=2)
    with pytest.raises(RejectionException, match="simulation 0 of seed 0 is always rejected"):
        env.reset(seed=0)
    with pytest.raises(ValueError, match="render_mode"):
        environment(render_mode="human")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"max_steps": 0}, "`max_steps` must be an integer of at least 1, not 0"),
        ({"max_steps": 2.5}, "`max_steps` must be an integer of at least 1, not 2.5"),
        ({"tries": -1}, "`tries` must be an integer of at least 1, not -1"),
        ({"first": -1}, "`first` must be an integer of at least 0, not -1"),
        ({"stride": 0}, "`stride` must be an integer of at least 1, not 0"),
        ({"timestep": -0.1}, "`timestep` must be a positive number of seconds, not -0.1"),
        ({"image_size": (640, -480)}, "`image_size\\[1\\]` must be an integer of at least 1, not -480"),
    ],
)
def test_numbers_that_cannot_be_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        environment(**options)


def test_numbers_of_episodes_and_environments_that_cannot_be_are_refused() -> None:
    env = environment()
    for k in (-1, 0.5):
        with pytest.raises(ValueError, match=f"`k` must be an integer of at least 0, not {k}"):
            env.reset(seed=0, options={"k": k})
    with pytest.raises(ValueError, match="`num_envs` must be an integer of at least 1, not 0"):
        ScenicVectorEnv("absent.scenic", 0)


def test_without_the_library_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    monkeypatch.delitem(sys.modules, "scenic.gym")
    with pytest.raises(UnsupportedError, match="need the package gymnasium") as caught:
        importlib.import_module("scenic.gym")
    assert "scenic-lang[gym]" in str(caught.value.help)


def test_what_is_observed_must_be_present() -> None:
    text = "ego = new Object\nother = new Object at (5, 0), with present n > 0\nrecord ego.y as reward\n"
    text = f"n = DiscreteRange(0, 9)\nparam n = n\n{text}"
    scenes = scenic.scenarioFromString(text).sample(100, seed=0)
    absent = next(scene.k for scene in scenes if scene.params["n"] == 0)
    env = environment(text, observations={"ego": ["position"], "other": ["position"]})
    env.reset(seed=0)
    with pytest.raises(InvalidScenarioError, match=f"'other' takes no part in scene {absent} of seed 0"):
        env.reset(seed=0, options={"k": absent})


def test_environments_in_processes_play_the_episodes_of_the_seed() -> None:
    """Each has episodes of its own, which are those of one environment; and again after it is reset."""
    options: dict[str, Any] = {
        "actions": Choice([[], SetVelocity((0, 1, 0))]),
        "observations": ["position"],
        "reward": "reward",
        "simulator": "kinematic",
        "max_steps": 2,
    }
    text = "ego = new Object at (Range(0, 9), 0)\nrecord ego.y as reward\n"
    scenario = scenic.scenarioFromString(text)
    alone = ScenicEnv(scenario, **options)
    starts = []
    for k in range(4):
        observation, _ = alone.reset(seed=8, options={"k": k})
        starts.append(observation["ego.position"][0])
    vector = ScenicVectorEnv(scenario, 2, **options)
    try:
        for _ in range(2):
            observed, info = vector.reset(seed=8)
            assert info["k"].tolist() == [0, 1]
            played = [*observed["ego.position"][:, 0]]
            for number in range(3):  # the third step begins the next episodes
                observed, rewards, _, truncated, _ = vector.step(np.array([0, 1]))
                assert truncated.tolist() == [number == 1] * 2
            played += [*observed["ego.position"][:, 0]]
            assert played == starts
            assert rewards.tolist() == [0, 0]
    finally:
        vector.close()


def test_joints_are_actions_and_observations() -> None:
    pytest.importorskip("mujoco")
    from scenic.simulators.mujoco import SetJointPositions

    path = Path(__file__).parents[1] / "examples" / "arm" / "arm.xml"
    text = f"""
model scenic.simulators.mujoco.model
ego = new Robot at (0, 0, 0.04), with description r"{path}", with joints {{'turn': Range(-1, 1)}}
"""
    limits = joint_limits(path)
    env = ScenicEnv(
        scenic.scenarioFromString(text),
        actions=Joints(SetJointPositions, limits),
        observations=["jointValues", "jointVelocities"],
        reward=lambda now: -abs(now.agent.jointValues["turn"] - 0.5),
    )
    assert env.action_space.shape == (len(limits),)
    observed, _ = env.reset(seed=1)
    assert observed["ego.jointValues"].shape == (len(limits),)
    target = np.zeros(len(limits), np.float32)
    target[list(limits).index("turn")] = 0.5
    for _ in range(30):
        observed, reward, *_ = env.step(target)
    assert reward == pytest.approx(0, abs=0.03)
    env.close()
