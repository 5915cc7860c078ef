"""Pages of this package in headless Chromium."""

import base64
import io
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import PIL.Image
import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

BROWSER = shutil.which("chromium") or shutil.which("google-chrome")
DRIVER = shutil.which("chromedriver")
SIZE = (1300, 900)

MARKS = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not (BROWSER and DRIVER), reason="needs Chromium: apt-get install chromium chromium-driver"
    ),
]


@contextmanager
def opened(address: str) -> Iterator[webdriver.Chrome]:
    """A browser at an address, whose console must show no error until it is closed."""
    options = webdriver.ChromeOptions()
    options.binary_location = str(BROWSER)
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--disable-dev-shm-usage",
        "--disable-background-networking",
        "--disable-component-update",
        "--enable-unsafe-swiftshader",
        f"--window-size={SIZE[0]},{SIZE[1]}",
    ):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    try:
        driver.get(address)
        time.sleep(1)
        yield driver
        severe = [line for line in driver.get_log("browser") if line["level"] == "SEVERE"]
        assert not severe
    finally:
        driver.quit()


def picture(browser: webdriver.Chrome) -> np.ndarray:
    """What the canvas shows."""
    time.sleep(0.4)
    text = browser.find_element("id", "view").screenshot_as_base64
    image = PIL.Image.open(io.BytesIO(base64.b64decode(text))).convert("RGB")
    return np.asarray(image).astype(int)


def count(image: np.ndarray, channel: int) -> int:
    others = [other for other in range(3) if other != channel]
    return int((image[..., channel] > 2 * image[..., others].max(axis=-1)).sum())
