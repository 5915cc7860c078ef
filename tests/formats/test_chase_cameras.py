"""Cameras that follow an object."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from scenic.formats.camera import Camera, Outlook
from scenic.formats.chase_cameras import BEHIND, CameraFollowError, Track

BEHIND_IT = Outlook(azimuth=BEHIND[0], elevation=BEHIND[1], follow="ego")


def item(x: float, y: float, heading: float, name: str | None = "ego") -> Any:
    turn = (0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2))
    return SimpleNamespace(
        position=(x, y, 0.75),
        quaternion=turn,
        size=(2, 4.5, 1.5),
        name=name,
        is_ego=name == "ego",
        label=name or "Car",
    )


def seen(camera: Camera, point: tuple[float, float, float]) -> tuple[float, float]:
    """The place of a point before the camera in the picture: -1 to 1 to the right and upwards."""
    away = np.array(point) - camera.eye
    depth = away @ camera.ahead
    assert depth > 0
    return away @ camera.right / depth / camera.tangents[0], away @ camera.up / depth / camera.tangents[1]


@pytest.mark.parametrize("heading", [0.0, 1.0, -2.5, math.pi])
def test_the_camera_stands_behind_and_above(heading: float) -> None:
    camera = Track([[item(3, 4, heading)]], "ego", 0.1).camera(0, 4 / 3, BEHIND_IT)
    ahead = np.array([-math.sin(heading), math.cos(heading)])
    from_it = camera.eye[:2] - (3, 4)
    assert from_it @ ahead < -5
    assert abs(from_it @ np.array([ahead[1], -ahead[0]])) < 1e-9
    assert camera.eye[2] > 3
    across, up = seen(camera, (3, 4, 0.75))
    assert (across, up) == (pytest.approx(0, abs=1e-9), pytest.approx(-0.2, abs=0.3))


def test_from_above_what_is_ahead_is_up() -> None:
    above = Outlook(azimuth=0, elevation=90, follow="ego", reach=30)
    camera = Track([[item(0, 0, 1.2)]], "ego", 0.1).camera(0, 1, above)
    across, up = seen(camera, (-20 * math.sin(1.2), 20 * math.cos(1.2), 0.75))
    assert across == pytest.approx(0, abs=1e-9)
    assert 0 < up < 1
    assert seen(camera, (0, 0, 0.75))[1] < up


def test_the_direction_is_steady_and_the_object_stays_in_place() -> None:
    rng = np.random.default_rng(1)
    states = [[item(k, 0, -math.pi / 2 + 0.1 * rng.standard_normal())] for k in range(50)]
    track = Track(states, "ego", 0.1)
    azimuths = [math.atan2(*track.camera(k, 1, BEHIND_IT).ahead[:2]) for k in range(50)]
    assert np.ptp(azimuths) < 0.3
    places = [seen(track.camera(k, 1, BEHIND_IT), states[k][0].position) for k in range(50)]
    assert np.ptp(np.array(places), axis=0).max() < 0.1


def test_turns_of_more_than_half_a_circle_are_followed() -> None:
    states = [[item(0, 0, 0.1 * k)] for k in range(100)]
    track = Track(states, "ego", 0.1)
    for k in range(10, 90):
        difference = math.atan2(*track.camera(k, 1, BEHIND_IT).ahead[:2]) + 0.1 * k
        assert abs((difference + math.pi) % (2 * math.pi) - math.pi) < 1e-6


def test_the_camera_waits_where_an_object_comes() -> None:
    states = [[item(0, 0, 0)], [item(0, 0, 0), item(9, 9, 1, "late")]]
    track = Track(states, "late", 0.1)
    np.testing.assert_allclose(track.camera(0, 1, BEHIND_IT).eye, track.camera(1, 1, BEHIND_IT).eye)
    Track(states, 1, 0.1)


@pytest.mark.parametrize(
    ("name", "help"), [("egoo", "did you mean 'ego'?"), (7, "or give a number from 0 to 0")]
)
def test_an_unknown_object_is_reported(name: str | int, help: str) -> None:
    with pytest.raises(CameraFollowError, match="no object") as caught:
        Track([[item(0, 0, 0)]], name, 0.1)
    assert caught.value.code == "SC604"
    assert help in str(caught.value.help)
