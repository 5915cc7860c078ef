"""Arms: ``python -m benchmarks.arms [scenes | reaching | kinematics [FILE ...]]``; all by default.

``scenes``: scenes a second of an arm with seven random joints and twenty things, and where their time goes. ``kinematics``: the frames of all links
of robots' files beside MuJoCo's, over 1,000 random configurations: our own files, those given, and those of PyBullet's data and of robosuite
where these packages are installed.
"""

import argparse
import cProfile
import importlib.util
import pstats
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import scenic
from scenic.language.errors import Located
from scenic.runtime.shapes.shapes import BoxShape
from scenic.simulators.mujoco.kinematics import forward
from scenic.simulators.mujoco.library import library, quietly
from scenic.simulators.mujoco.reaching import _Arm
from scenic.simulators.mujoco.robot_descriptions import Description, read_description

HERE = Path(__file__).parent
PROGRAMS = (HERE / "arms" / "cluttered.scenic", HERE / "arms" / "thrown.scenic")
OURS = (HERE / "arms" / "seven.xml", *sorted((HERE.parent / "examples" / "arm").glob("*.xml")))
BULLET = (
    "kuka_iiwa/model.urdf",
    "a1/a1.urdf",
    "aliengo/aliengo.urdf",
    "laikago/laikago_toes_zup.urdf",
    "r2d2.urdf",
    "mjcf/humanoid.xml",
    "mjcf/thrower.xml",
    "quadruped/minitaur.urdf",
    "quadruped/vision60.urdf",
    "racecar/racecar.urdf",
)
ROBOSUITE = ("panda", "sawyer", "ur5e", "iiwa", "kinova3", "jaco", "baxter")
CONFIGURATIONS = 1000
PLACES = 200
SCENES = 2000


def scenes(path: Path) -> None:
    """Print scenes a second of a program, and the share of the time of the dearest functions."""
    scenario = scenic.load(path)
    scenario.sample(100, seed=0)
    seconds = []
    for seed in range(1, 4):
        start_time = time.process_time()
        drawn = scenario.sample(SCENES, seed=seed)
        seconds.append(time.process_time() - start_time)
    candidates = sum(scene.attempts for scene in drawn) / SCENES
    print(
        f"{path.stem:12} {SCENES / min(seconds):6,.0f} scenes/s, {candidates:.1f} candidates a scene, "
        f"{candidates * SCENES / min(seconds):,.0f} candidates/s"
    )
    profile = cProfile.Profile()
    profile.enable()
    scenario.sample(SCENES, seed=4)
    profile.disable()
    table = pstats.Stats(profile)
    total = sum(entry[2] for entry in table.stats.values())  # type: ignore[attr-defined] # not in its stubs
    shares: dict[str, float] = {}
    for (file, _, _), entry in table.stats.items():  # type: ignore[attr-defined]
        name = file.partition("/scenic/")[2].rpartition("/")[0] if "/scenic/" in file else "NumPy and Python"
        shares[name] = shares.get(name, 0.0) + entry[2] / total
    for name, share in sorted(shares.items(), key=lambda item: -item[1])[:8]:
        print(f"    {share:4.0%} {name}")


def files(given: list[str]) -> Iterator[Path]:
    """Descriptions of robots that are there."""
    yield from OURS
    yield from map(Path, given)
    for package, places in (
        ("pybullet_data", BULLET),
        ("robosuite", [f"models/assets/robots/{name}/robot.xml" for name in ROBOSUITE]),
    ):
        spec = importlib.util.find_spec(package)
        if spec is None or spec.origin is None:
            print(f"{package} is not installed")
            continue
        yield from (path for place in places if (path := Path(spec.origin).parent / place).is_file())


def deviation(path: Path, description: Description) -> tuple[float, float]:
    """The greatest distance (metres) and the greatest angle (radians) between our frames of links and MuJoCo's."""
    mujoco = library()
    with quietly():
        spec = mujoco.MjSpec.from_file(str(path))
        for joint in [item for item in spec.joints if item.type == mujoco.mjtJoint.mjJNT_FREE]:
            spec.delete(joint)
        model = spec.compile()
    data = mujoco.MjData(model)
    generator = np.random.default_rng(1)
    values = {
        name: generator.uniform(max(joint.low, -3), min(joint.high, 3), CONFIGURATIONS)
        for name, joint in description.joints.items()
    }
    frames = [
        (
            mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, link.name),
            *forward(link.chain, [values[joint.name] for joint in link.joints]),
        )
        for link in description.links[1:]
    ]
    hinges = [
        number
        for number in range(model.njnt)
        if model.jnt_type[number] in (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    ]
    slots = dict(zip(description.joints, model.jnt_qposadr[hinges].tolist(), strict=True))
    furthest = turned = 0.0
    for number in range(CONFIGURATIONS):
        for name, column in values.items():
            data.qpos[slots[name]] = column[number]
        mujoco.mj_kinematics(model, data)
        for body, places, turns in frames:
            furthest = max(furthest, float(np.abs(places[number % len(places)] - data.xpos[body]).max()))
            x, y, z, w = turns[number % len(turns)]
            ours, theirs = np.array([w, x, y, z]), data.xquat[body]
            turned = max(turned, 2 * float(min(np.abs(ours - theirs).max(), np.abs(ours + theirs).max())))
    return furthest, turned


def kinematics(given: list[str]) -> None:
    """Print the deviations of robots' files."""
    count, worst = 0, 0.0
    for path in files(given):
        name = f"{path.parent.name}/{path.name}"
        try:
            description = read_description(path)
        except Located as error:
            print(f"{name:32} {error}")
            continue
        furthest, turned = deviation(path, description)
        count, worst = count + 1, max(worst, furthest, turned)
        print(
            f"{name:32} {len(description.joints):3} joints, {len(description.links):3} links: {furthest:.1e} m, {turned:.1e} rad"
        )
    print(
        f"{count} files, {CONFIGURATIONS} configurations each: the greatest deviation is {worst:.1e} (1e-9 allowed)"
    )


def reaching() -> None:
    """Print how often `reaches` agrees with brute force, over 200 places of an arm between three pillars."""
    mujoco = library()
    pillars = [
        ((0.45, 0.1, 0.4), (0.1, 0.1, 0.8)),
        ((-0.3, 0.4, 0.3), (0.1, 0.3, 0.6)),
        ((0.0, -0.5, 0.5), (0.4, 0.05, 1.0)),
    ]
    mesh = BoxShape().mesh
    arm = _Arm(str(OURS[1]), [(mesh, size) for _, size in pillars])
    arm.put([(np.array(place), np.array([0.0, 0.0, 0.0, 1.0])) for place, _ in pillars])
    chain = arm.description.frame("grip")
    joints = [joint for segment in chain for joint in segment.joints]
    generator = np.random.default_rng(5)
    values = generator.uniform(
        [joint.low for joint in joints], [joint.high for joint in joints], (1_000_000, len(joints))
    )
    tips = forward(chain, list(values.T))[0]
    tree = cKDTree(tips)
    agree = unsure = 0
    for place in generator.uniform((-0.8, -0.8, 0.05), (0.8, 0.8, 1.0), (PLACES, 3)):
        free = False
        # What is a little too far away may be an arm at its full length.
        for number in tree.query_ball_point(place, 0.012):
            for joint, value in zip(joints, values[number].tolist(), strict=True):
                arm.data.joint(joint.name).qpos[0] = value
            mujoco.mj_forward(arm.model, arm.data)
            if not arm.data.ncon or arm.data.contact.dist.min() > -1e-3:
                free = True
                break
        answer = arm.solves("grip", place, down=None, tolerance=0.01)
        if answer == free:
            agree += 1
        elif answer:
            unsure += 1  # a solution that contacts were looked for at, which too few tries have missed
    print(
        f"{PLACES} places: {agree} agree, {unsure} with a solution that brute force missed, {PLACES - agree - unsure} missed by `reaches`"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", nargs="?", choices=("scenes", "reaching", "kinematics"))
    parser.add_argument("files", nargs="*", help="more descriptions for `kinematics`")
    options = parser.parse_args()
    if options.part in (None, "scenes"):
        for path in PROGRAMS:
            scenes(path)
    if options.part in (None, "reaching"):
        reaching()
    if options.part in (None, "kinematics"):
        kinematics(options.files)


if __name__ == "__main__":
    main()
