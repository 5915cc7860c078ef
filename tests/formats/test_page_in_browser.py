"""The page of scenes as its user meets it, in headless Chromium."""

import time
from collections.abc import Iterator

import numpy as np
import pytest
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains

import scenic
from scenic.formats.html import page
from tests.formats.browsers import MARKS, count, opened, picture

pytestmark = MARKS

PROGRAM = """
workspace = Workspace(RectangularRegion((0, 0, 0), 0, 600, 400))
zone = RectangularRegion((0, 0, 0), 0, 12, 12)
ego = new Object at (Range(-1, 1), 0, 1), with width 2, with length 2, with height 2, with color (1, 0, 0)
new Object at (4, 4, 1), with color (0, 0, 1)
"""


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[webdriver.Chrome]:
    target = tmp_path_factory.mktemp("page") / "page.html"
    target.write_text(page(scenic.scenarioFromString(PROGRAM).sample(4, seed=1), "page"), encoding="utf-8")
    with opened(target.as_uri() + "#k=2") as driver:
        yield driver


def press(browser: webdriver.Chrome, keys: str) -> None:
    ActionChains(browser).send_keys(*keys).perform()


def layer(browser: webdriver.Chrome, name: str) -> None:
    browser.execute_script(f"document.querySelector('[data-layer=\"{name}\"]').click()")


def test_an_address_opens_a_scene_and_keys_step_on(browser: webdriver.Chrome) -> None:
    browser.execute_script("location.hash = '#k=2'")
    time.sleep(0.3)
    assert "k 2" in browser.find_element("id", "facts").text
    press(browser, "\ue014")  # to the right
    assert browser.current_url.endswith("#k=3")
    browser.execute_script("location.hash = '#k=1'")
    time.sleep(0.3)
    assert "k 1" in browser.find_element("id", "facts").text


def test_objects_are_hidden_isolated_and_shown_again(browser: webdriver.Chrome) -> None:
    press(browser, "r")
    both = picture(browser)
    assert count(both, 0) > 500
    assert count(both, 2) > 100
    browser.execute_script("document.getElementById('objects').children[1].click()")
    press(browser, "h")
    assert count(picture(browser), 2) == 0
    press(browser, "u")
    browser.execute_script("document.getElementById('objects').children[0].click()")
    press(browser, "i")
    alone = picture(browser)
    assert count(alone, 2) == 0
    press(browser, "u")
    browser.execute_script("document.getElementById('objects').children[0].click()")


def test_layers_are_drawn_and_switched(browser: webdriver.Chrome) -> None:
    press(browser, "r")
    for name in ("regions", "views", "headings", "labels", "grid"):
        before = picture(browser)
        layer(browser, name)
        after = picture(browser)
        assert (before != after).any(), name
        layer(browser, name)
        assert (picture(browser) == before).all(), name
    before = picture(browser)
    browser.execute_script("document.querySelector('#regions input').click()")
    assert (picture(browser) != before).any()
    browser.execute_script("document.querySelector('#regions input').click()")


def test_the_ground_is_not_cut_near_the_camera(browser: webdriver.Chrome) -> None:
    """In a wide scene, seen from close to an object, the ground reaches below the camera."""
    press(browser, "0")
    browser.execute_script("document.getElementById('objects').children[0].click()")
    press(browser, "f")
    layer(browser, "grid")
    close = picture(browser)
    layer(browser, "grid")
    browser.execute_script("document.getElementById('objects').children[0].click()")
    background = np.array([232, 236, 242])
    bottom = close[-40:-5, 200:-20]
    assert (np.abs(bottom - background).max(axis=-1) > 4).mean() > 0.95


def test_a_picture_is_saved_and_maps_have_no_perspective(browser: webdriver.Chrome) -> None:
    browser.execute_script(
        "window.saved = null; HTMLAnchorElement.prototype.click = function () { window.saved = this.download; }"
    )
    press(browser, "p")
    end = time.monotonic() + 20
    while not (name := browser.execute_script("return window.saved")) and time.monotonic() < end:
        time.sleep(0.1)
    assert str(name).endswith(".png")
    press(browser, "5r")
    above = picture(browser)[:, 120:]  # without the compass
    red = np.argwhere((above[..., 0] > 2 * above[..., 1]) & (above[..., 0] > 2 * above[..., 2]))
    height, width = np.ptp(red, axis=0)
    assert abs(height - width) <= 3  # the roof of a cube, and none of its walls


def test_two_clicks_measure_a_distance(browser: webdriver.Chrome) -> None:
    press(browser, "5rm")
    time.sleep(0.4)
    canvas = browser.find_element("id", "view")
    for x in (-60, 60):
        ActionChains(browser).move_to_element_with_offset(canvas, x, 0).click().perform()
    time.sleep(0.4)
    assert browser.find_element("css selector", "#labels span").text.endswith(" m")
    press(browser, "m")
