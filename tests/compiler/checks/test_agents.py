"""Behaviors whose actions an object cannot take."""

from pathlib import Path

import pytest

from tests.project.test_checks import findings

HEAD = """\
param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model
behavior Twice():
    do FollowLaneBehavior() for 2 seconds
    do UTurnBehavior()
behavior Push():
    while True:
        take SetThrottleAction(1)
behavior Either():
    if self.isPedestrian:
        take SetWalkingSpeedAction(1)
        terminate
    take SetThrottleAction(1)
behavior Asked():
    if self.isVehicle:
        take SetThrottleAction(1)
behavior Own():
    take 3
class Tram(Bus):
    length: 30
class Crowd(Pedestrian):
    width: 3
"""


def found(folder: Path, line: str, head: str = HEAD) -> list[str]:
    program = head + line + "\n"
    return [
        item.message
        for item in findings(folder / "drive.scenic", program)
        if item.code == "SC314" and item.span is not None and item.span.line == program.count("\n")
    ]


@pytest.mark.parametrize(
    "behavior", ["Twice", "Push", "DriveByRulesBehavior", "FollowLaneBehavior", "UTurnBehavior"]
)
@pytest.mark.parametrize("cls", ["Pedestrian", "Crowd", "Object"])
def test_what_has_no_wheel_cannot_drive(cls: str, behavior: str, tmp_path: Path) -> None:
    expected = [f"objects of the class `{cls}` cannot drive, as `{behavior}` does"]
    assert found(tmp_path, f"new {cls} with behavior {behavior}()") == expected
    assert found(tmp_path, f"new {cls} with speed 3, with behavior {behavior}") == expected


def test_vehicles_cannot_walk(tmp_path: Path) -> None:
    expected = ["objects of the class `Tram` cannot walk, as `WalkTo` does"]
    assert found(tmp_path, "new Tram with behavior WalkTo(ego)") == expected
    # It walks whatever it finds where it stands.
    expected = ["objects of the class `Tram` cannot walk, as `WalkForwardBehavior` does"]
    assert found(tmp_path, "new Tram with behavior WalkForwardBehavior()") == expected


@pytest.mark.parametrize(
    "line",
    [
        "new Car with behavior Twice()",
        "new Tram with behavior Push()",
        "new Pedestrian with behavior WalkTo(ego)",
        "new Pedestrian with behavior Either()",
        "new Pedestrian with behavior Asked()",
        "new Pedestrian with behavior Own()",
        "new Unknown with behavior Push()",
        "new Pedestrian with behavior Unknown()",
    ],
)
def test_what_is_right_or_unknown_is_not_reported(line: str, tmp_path: Path) -> None:
    assert found(tmp_path, line) == []


def test_vehicles_of_the_general_model_can_drive(tmp_path: Path) -> None:
    head = HEAD.replace("simulators.newtonian.driving_model", "domains.driving.model")
    assert found(tmp_path, "new Bicycle with behavior Push()", head) == []
    assert len(found(tmp_path, "new Pedestrian with behavior Push()", head)) == 1


def test_rules_that_are_not_there_are_named(tmp_path: Path) -> None:
    program = HEAD + "new Car with behavior DriveByRulesBehavior(ignore={'speedlimit', 'signals'})\n"
    program += "new Car with behavior DriveByRulesBehavior(ignore='signal')\n"
    wrong = [(item.code, item.message, item.help) for item in findings(tmp_path / "drive.scenic", program)]
    assert ("SC401", "there is no rule 'speedlimit' to ignore", "did you mean 'speed_limits'?") in wrong
    assert ("SC401", "there is no rule 'signal' to ignore", "did you mean 'signals'?") in wrong
    assert sum(code == "SC401" for code, _, _ in wrong) == 2


def test_other_programs_are_left_alone(tmp_path: Path) -> None:
    assert found(tmp_path, "new Object with behavior Go()", "behavior Go():\n    take 1\n") == []
