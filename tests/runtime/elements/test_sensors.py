"""What sensors are made of, and what they observe without a simulator."""

import math

import numpy as np
import pytest

from scenic.language.errors import InvalidScenarioError
from scenic.runtime.elements.sensors import (
    CallbackSensor,
    CameraSensor,
    DepthSensor,
    GroundTruthSensor,
    RGBSensor,
    Sensor,
    SSSensor,
)
from tests.runtime.programs import scenario


@pytest.mark.parametrize("name", ["width", "height"])
def test_cameras_have_whole_pixels(name: str) -> None:
    for size in (1, 16384):
        assert getattr(CameraSensor(**{name: size}), name) == size
    for size in (0, -1, 16385, 2.0, "9", None, True):
        with pytest.raises(
            InvalidScenarioError, match=f"the {name} of a RGBSensor must be a number of pixels"
        ):
            RGBSensor(**{name: size})  # type: ignore[arg-type] # that is what it refuses


def test_cameras_open_less_than_half_around() -> None:
    assert CameraSensor().fieldOfView == pytest.approx(math.radians(90))
    for angle in (0.001, 60, 179.999):
        assert CameraSensor(attributes={"fov": angle}).fieldOfView == pytest.approx(math.radians(angle))
    for wrong in (0, 180, -20, "90", True, math.nan, None):
        with pytest.raises(InvalidScenarioError, match="the field of view of a DepthSensor"):
            DepthSensor(attributes={"fov": wrong})


def test_cameras_are_fixed_on_their_objects() -> None:
    camera = CameraSensor(
        offset=[1, 2, "3"], rotation=np.array([0, 1, 2]), width=7, height=9, attributes={"a": 1}
    )
    assert (camera.offset, camera.rotation, camera.attributes) == ((1, 2, 3), (0, 1, 2), {"a": 1})
    assert (CameraSensor().offset, CameraSensor().rotation, CameraSensor().width, CameraSensor().height) == (
        None,
        (0, 0, 0),
        640,
        480,
    )
    assert repr(camera) == "CameraSensor(width=7, height=9)"
    drawn = scenario("param x = Range(0, 1), v = Vector(Range(0, 1), 2, 3)").params
    for wrong in ((1, 2), (1, 2, 3, 4), 5, "abc", (1, None, 2), (drawn["x"], 0, 0), drawn["v"]):
        for name in ("offset", "rotation"):
            with pytest.raises(
                InvalidScenarioError, match=f"the {name} of a sensor must be three finite numbers"
            ):
                CameraSensor(**{name: wrong})  # type: ignore[arg-type] # that is what it refuses
    assert (RGBSensor.outputs, DepthSensor.outputs, SSSensor.outputs) == (
        ("rgb",),
        ("depth",),
        ("semantic", "instance"),
    )


def test_truths_are_observed_as_they_are_at_each_step() -> None:
    values = [1]
    listed, called, fixed = (
        GroundTruthSensor(values),
        GroundTruthSensor(lambda: len(values)),
        GroundTruthSensor(None),
    )
    values.append(2)
    assert (listed.getObservation(), called.getObservation(), fixed.getObservation()) == ([1, 2], 2, None)
    assert CallbackSensor().getObservation() is None


def test_cameras_keep_what_was_said_of_them_when_they_were_made() -> None:
    given = {"fov": 60, "exposure": 3}
    one, other = RGBSensor(attributes=given), RGBSensor(attributes=given)
    given["exposure"] = 4
    one.attributes["gain"] = 2
    assert one.attributes == {"fov": 60, "exposure": 3, "gain": 2}
    assert other.attributes == {"fov": 60, "exposure": 3}
    assert CameraSensor().attributes == {}


def test_data_are_observed_as_they_are_processed() -> None:
    class Doubled(CallbackSensor):
        def process(self, data: int) -> int:
            return 2 * data

    sensor = Doubled(-1)
    assert sensor.getObservation() == -1
    for data in (3, 0):
        sensor.onData(data)
        assert sensor.getObservation() == 2 * data
    with pytest.raises(NotImplementedError, match="CallbackSensor does not say how data are processed"):
        CallbackSensor().onData(1)


def test_the_latest_delivery_is_observed() -> None:
    sensor, other = Sensor(), RGBSensor()
    assert (sensor.getObservation(), other.getObservation()) == (None, None)
    for value in (1, None, [2]):
        sensor.deliver(value)
        assert sensor.getObservation() is value
    assert other.getObservation() is None
