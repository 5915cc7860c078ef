"""The playground as its user meets it, in headless Chromium."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from tests.formats.browsers import MARKS, opened

pytestmark = MARKS


@pytest.fixture
def page(playground: Callable[..., Any]) -> Iterator[webdriver.Chrome]:
    with playground() as address, opened(address) as driver:
        until(lambda: driver.execute_script("return document.body.dataset.server") == "ready")
        yield driver


def until(holds: Callable[[], Any], seconds: float = 40) -> Any:
    end = time.monotonic() + seconds
    while not (found := holds()):
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.1)
    return found


def press(page: webdriver.Chrome, *keys: str, control: bool = False) -> None:
    actions = ActionChains(page)
    if control:
        actions.key_down(Keys.CONTROL)
    for key in keys:
        actions.send_keys(key)
    if control:
        actions.key_up(Keys.CONTROL)
    actions.perform()


def program(page: webdriver.Chrome) -> str:
    """What the editor shows."""
    return page.find_element(By.CSS_SELECTOR, "#editor .view-lines").text.replace("\u00a0", " ")


def squiggles(page: webdriver.Chrome) -> list[Any]:
    return page.find_elements(By.CSS_SELECTOR, "#editor .squiggly-error")


def sample(page: webdriver.Chrome) -> None:
    """Press the button, and wait until other scenes than before are drawn."""
    before = page.execute_script("return document.body.dataset.scene ?? null")
    page.find_element(By.ID, "sample").click()
    until(lambda: page.execute_script("return document.body.dataset.scene ?? null") != before)
    name = page.execute_script("return document.body.dataset.scene")
    page.switch_to.frame("scene")
    try:
        until(lambda: page.execute_script("return location.pathname").endswith(name))
        until(lambda: page.find_element(By.ID, "facts").text)
    finally:
        page.switch_to.default_content()


def picture(page: webdriver.Chrome) -> bytes:
    """The scene as it is drawn, once two pictures of it are equal."""
    frame = page.find_element(By.ID, "scene")
    last = b""
    while last != (last := frame.screenshot_as_png):
        time.sleep(0.3)
    return last


def check_repair(page: webdriver.Chrome) -> None:
    """A mistake is underlined as it is typed; the repair that is offered takes the line away."""
    until(lambda: "require" in program(page))
    assert not squiggles(page)
    page.find_element(By.CSS_SELECTOR, "#editor .view-lines").click()
    press(page, Keys.END, control=True)
    press(page, "box = new Object lef of chair")
    press(page, Keys.ESCAPE)
    until(lambda: squiggles(page))
    for _ in range(len(" of chair") + 1):
        press(page, Keys.ARROW_LEFT)
    press(page, ".", control=True)
    until(lambda: page.find_elements(By.CSS_SELECTOR, ".action-widget .action"))
    press(page, Keys.ENTER)
    until(lambda: "left of chair" in program(page))
    until(lambda: not squiggles(page))


def check_scenes(page: webdriver.Chrome) -> None:
    """Scenes come when the button is pressed, differ, and can be turned."""
    empty = picture(page)
    sample(page)
    first = picture(page)
    assert first != empty
    frame = page.find_element(By.ID, "scene")
    drag = ActionChains(page).move_to_element_with_offset(frame, 0, -150).click_and_hold()
    drag.move_by_offset(120, 30).release().perform()
    turned = picture(page)
    assert turned != first
    sample(page)
    assert picture(page) != turned


def check_trouble(page: webdriver.Chrome) -> None:
    """What the program's fault is, is said where the scene would be."""
    page.find_element(By.CSS_SELECTOR, "#editor .view-lines").click()
    press(page, "a", control=True)
    press(page, "x = 1 / 0")
    press(page, Keys.ESCAPE)
    press(page, Keys.ENTER, control=True)
    trouble = page.find_element(By.ID, "trouble")
    until(lambda: "ZeroDivisionError" in trouble.text)
    assert page.find_element(By.ID, "status").text == "no scene"


def test_one_session(page: webdriver.Chrome) -> None:
    # One test, since a browser is dear: what comes later begins where the steps before ended.
    check_repair(page)
    check_scenes(page)
    check_trouble(page)
    assert [each["message"] for each in page.get_log("browser") if each["level"] == "SEVERE"] == []
