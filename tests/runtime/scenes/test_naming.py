"""Names of draws: what the user wrote, and the values and units that go with it."""

import scenic

PROGRAM = """
speed = Range(1, 5)
param wind = Normal(0, 2)
class Toy:
    width: Range(0.1, 0.3)
    color: Uniform((1, 0, 0), (0, 1, 0))
ego = new Object on RectangularRegion((1, 0, 0), 0, 4, 6), facing Range(0, 90) deg
near = CircularRegion(ego.position, 1)
toys = [new Toy at (2 + speed, 20 + 2 * index) for index in range(2)]
for index in range(2):
    new Toy at (Range(-5, 5), 30 + 2 * index), with speed Uniform(2, 3, 5)
chair = new Object at (-20, 0)
mutate chair
"""


def named(text: str) -> dict[str, tuple[tuple[float, float] | None, str]]:
    scenario = scenic.scenarioFromString(text)
    names = [axis.name for axis in scenario.axes]
    assert len({name.text for name in names}) == len(names)
    return {name.text: (name.ends, name.unit) for name in names}


def test_draws_are_named_by_what_they_decide() -> None:
    found = named(PROGRAM)
    assert found["speed"] == ((1, 5), "")
    assert found["wind"] == (None, "")  # a normal law does not grow evenly
    assert found["ego.position.x"] == ((-1, 3), "m")
    assert found["ego.position.y"] == ((-3, 3), "m")
    assert found["ego.yaw"] == ((0, 1.570796327), "rad")
    assert found["toys[1].width"] == ((0.1, 0.3), "m")
    assert found["Toy[0].color"] == (None, "")
    assert found["Toy[1].position.x"] == ((-5, 5), "m")
    assert found["Toy[1].speed"] == (None, "")
    assert {"chair.position.x", "chair.position.y", "chair.yaw"} <= found.keys()
    assert not any(name.startswith(("near", "index")) for name in found)


def test_default_positions_are_those_of_the_object_and_defaults_those_of_the_behavior() -> None:
    found = named(
        "class Toy:\n    position: new Point in CircularRegion((0, 0), 3)\n"
        "behavior Go(speed=Range(1, 2)):\n    wait\nego = new Toy\nhome = new Point in CircularRegion((9, 9), 1)\n"
    )
    assert {name.partition(" ")[0] for name in found} == {"ego.position", "home.position", "Go.speed"}
    assert found["Go.speed"] == ((1, 2), "")


def test_a_distance_that_moves_along_no_axis_has_the_values_of_its_range() -> None:
    found = named(
        "ego = new Object at (Range(1, 2), 0), facing Range(0, 1)\nbox = new Object ahead of ego by Range(8, 20)\n"
    )
    assert found["ego.position.x"] == ((1, 2), "m")
    assert found["box.position"] == ((8, 20), "of Range(8, 20)")


def test_values_are_those_of_scenes() -> None:
    scenario = scenic.scenarioFromString(PROGRAM)
    points = scenic.GivenPoints([[0.25 + 0.01 * place for place in range(len(scenario.axes))]])
    (scene,) = scenario.stream(1, seed=0, source=points)
    ego = scene.egoObject
    values = {"ego.position.x": ego.position.x, "ego.position.y": ego.position.y, "ego.yaw": ego.yaw}
    for place, axis in enumerate(scenario.axes):
        if axis.name.text in values:
            low, high = axis.name.ends
            assert abs(low + (high - low) * (0.25 + 0.01 * place) - values.pop(axis.name.text)) < 1e-8
    assert not values


def test_external_parameters_are_named_where_only_a_variable_holds_them() -> None:
    scenario = scenic.scenarioFromString(
        "spare = VerifaiRange(1, 2)\nego = new Object at (VerifaiRange(0, 5), 0)"
    )
    assert [scenario.draw_names[address].text for address in scenario.externals] == [
        "spare",
        "ego.position.x",
    ]


def test_arguments_of_behaviors_are_named_by_their_parameters() -> None:
    scenario = scenic.scenarioFromString(
        "behavior Go(speed, gap=3):\n    wait\nego = new Object with behavior Go(Range(1, 10), gap=Range(0, 1))\n"
    )
    assert [name.text for name in scenario.draw_names.values()] == ["ego.behavior.speed", "ego.behavior.gap"]
