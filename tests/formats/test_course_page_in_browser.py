"""The page that plays simulations as its user meets it, in headless Chromium."""

import time
from collections.abc import Iterator

import numpy as np
import pytest
from selenium import webdriver

from scenic.formats.course_page import course_page
from tests.formats.browsers import MARKS, count, opened, picture
from tests.formats.test_course_page import data_of, simulated

pytestmark = MARKS


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[webdriver.Chrome]:
    target = tmp_path_factory.mktemp("page") / "page.html"
    target.write_text(course_page("page", [data_of(simulated()), data_of(simulated(20))]))
    with opened(target.as_uri() + "#k=0&t=1.5") as driver:
        yield driver


def to(browser: webdriver.Chrome, step: int) -> np.ndarray:
    browser.execute_script(
        f"const t = document.getElementById('time'); t.value = {step}; t.dispatchEvent(new Event('input'))"
    )
    return picture(browser)


def now(browser: webdriver.Chrome) -> str:
    return browser.find_element("id", "now").text


def middle(image: np.ndarray) -> float:
    red = (image[..., 0] > 2 * image[..., 1]) & (image[..., 0] > 2 * image[..., 2])
    return float(np.nonzero(red)[1].mean())


def test_an_address_opens_a_moment(browser: webdriver.Chrome) -> None:
    assert now(browser) == "1.50 s, step 15 of 80"


def test_the_slider_moves_what_moves(browser: webdriver.Chrome) -> None:
    before, after = to(browser, 0), to(browser, 80)
    assert middle(after) > middle(before) + 30
    assert count(before, 2) == 0, "it does not exist yet"
    assert count(after, 2) > 50
    assert now(browser) == "8.00 s, step 80 of 80"
    assert (to(browser, 0) == before).all()


PLAYED = """
const done = arguments[0], found = [], time = document.getElementById('time');
const look = (now) => {
  found.push([now, Number(time.value)]);
  if (Number(time.value) < 80) requestAnimationFrame(look); else done(found);
};
document.getElementById('run').click();
requestAnimationFrame(look);
"""


def test_it_plays_in_real_time_to_the_end(browser: webdriver.Chrome) -> None:
    to(browser, 60)
    seen = np.array(browser.execute_async_script(PLAYED))
    assert (np.diff(seen[:, 1]) >= 0).all()
    assert seen[0, 1] < 80
    # Twenty steps of a tenth of a second, however slowly they are drawn.
    assert 1.8 < (seen[-1, 0] - seen[0, 0]) / 1000 < 4
    time.sleep(0.2)
    assert now(browser) == "8.00 s, step 80 of 80"
    assert browser.find_element("id", "run").text == "▶"


def test_verdicts_and_details_are_told(browser: webdriver.Chrome) -> None:
    told = [row.text.split("\n") for row in browser.find_elements("css selector", "#verdicts li")]
    assert told == [["inside", "presumably true, by 5"], ["away", "true, by 7"]]
    to(browser, 40)
    browser.execute_script("document.getElementById('objects').children[0].click()")
    assert "(-1, 0, 1) m" in browser.find_element("id", "details").text
    to(browser, 50)
    assert "(0, 0, 1) m" in browser.find_element("id", "details").text
    browser.execute_script("document.getElementById('objects').children[0].click()")


def test_the_view_goes_with_an_object(browser: webdriver.Chrome) -> None:
    to(browser, 40)
    browser.execute_script("document.getElementById('objects').children[0].click()")
    browser.find_element("id", "follow").click()
    places = [middle(to(browser, step)) for step in (40, 60, 80)]
    browser.find_element("id", "follow").click()
    assert np.ptp(places) < 12
    browser.execute_script("document.getElementById('objects').children[0].click()")


def test_another_simulation_has_another_length(browser: webdriver.Chrome) -> None:
    browser.find_element("id", "next").click()
    assert now(browser) == "0.00 s, step 0 of 20"
    assert "Simulation 2 of 2" in browser.find_element("id", "facts").text
    browser.find_element("id", "previous").click()
