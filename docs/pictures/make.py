"""Makes the pictures of ``docs/pictures.md`` again: ``python docs/pictures/make.py``; look at them before they are kept.

Needs Pillow, and Chromium with its driver for the page.
"""

import base64
import io
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import PIL.Image
import PIL.ImageDraw
import rich.console
import rich.text
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

from scenic.cli.render import Sources, render_text
from scenic.formats.camera import Outlook
from scenic.formats.html import page
from scenic.formats.labels import observe
from scenic.formats.png import png
from scenic.formats.scene_cameras import viewpoint
from scenic.language.errors import ScenicSyntaxError
from scenic.pipeline import load

HERE = Path(__file__).parent
EXAMPLES = HERE.parents[1] / "examples"
QUALITY = 88


def main() -> None:
    """Make all of them, or those whose names are given."""
    if not sys.argv[1:] or "diagnostic" in sys.argv[1:]:
        diagnostic()
    makers = {"room": room, "terrain": terrain, "occlusion": occlusion, "cameras": cameras}
    for name in [name for name in sys.argv[1:] if name in makers] if sys.argv[1:] else makers:
        image = makers[name]()
        image.convert("RGB").save(HERE / f"{name}.jpg", quality=QUALITY, optimize=True)
        print(f"{name}.jpg: {image.width} x {image.height}")


def diagnostic() -> None:
    """The message about a misspelt name, as a terminal shows it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "desk.scenic"
        path.write_text("table = new Object with width 1.2\nego = new Object left of tabel by 0.3\n")
        try:
            load(path)
        except ScenicSyntaxError as error:
            text = render_text(list(error.diagnostics), Sources(), True).replace(f"{folder}/", "")
    console = rich.console.Console(record=True, width=64, file=io.StringIO())
    console.print(rich.text.Text.from_ansi(text.rstrip()))
    (HERE / "diagnostic.svg").write_text(
        console.export_svg(title="scenic check desk.scenic"), encoding="utf-8"
    )


def room() -> PIL.Image.Image:
    """The furnished room."""
    (scene,) = load(EXAMPLES / "indoor" / "furnished_room.scenic").sample(1, seed=1)
    return PIL.Image.open(io.BytesIO(png(scene)))


def terrain() -> PIL.Image.Image:
    """Trees on hills."""
    (scene,) = load(HERE / "terrain.scenic").sample(1, seed=3)
    return PIL.Image.open(io.BytesIO(png(scene, outlook=Outlook(azimuth=-35, elevation=28))))


def cameras() -> PIL.Image.Image:
    """Colours, depth, classes and objects, as cameras of each type give them; numbers as colours."""
    (scene,) = load(HERE / "cameras.scenic").sample(1, seed=4)
    colours = observe(scene, viewpoint(scene, "rgb", None)).rgb
    assert colours is not None
    depth = observe(scene, viewpoint(scene, "depth", None)).depth
    observation = observe(scene, viewpoint(scene, "classes", None))
    near = np.where(np.isfinite(depth), 1 - np.clip((depth - 1) / 5, 0, 1), 0)
    grey = np.repeat((255 * near).astype(np.uint8)[..., None], 3, axis=2)
    kinds = sorted({type(thing).__name__ for thing in scene.objects})
    of_class = np.array([kinds.index(type(thing).__name__) for thing in scene.objects] + [-1])
    panels = [colours, grey, _painted(of_class[observation.objects]), _painted(observation.objects)]
    height, width, _ = colours.shape
    sheet = PIL.Image.new("RGB", (2 * width, 2 * height))
    draw = PIL.ImageDraw.Draw(sheet)
    titles = ("RGBSensor", "DepthSensor", "SSSensor: classes", "SSSensor: objects")
    for number, (panel, title) in enumerate(zip(panels, titles, strict=True)):
        place = (number % 2 * width, number // 2 * height)
        sheet.paste(PIL.Image.fromarray(panel), place)
        draw.rectangle((place[0], place[1], place[0] + 7 * len(title) + 8, place[1] + 16), fill=(20, 24, 30))
        draw.text((place[0] + 4, place[1] + 2), title, fill=(255, 255, 255))
    return sheet


def _painted(numbers: np.ndarray) -> np.ndarray:
    """A colour for each number; black for -1."""
    hues = (np.arange(256) * 0.6180339887) % 1
    table = np.array(
        [
            PIL.Image.new("HSV", (1, 1), (int(255 * hue), 150, 235)).convert("RGB").getpixel((0, 0))
            for hue in hues
        ],
        np.uint8,
    )
    return np.where(numbers[..., None] < 0, np.uint8(20), table[numbers % 256])


def occlusion() -> PIL.Image.Image:
    """The page of a scene with what the ego has in view."""
    (scene,) = load(HERE / "occlusion.scenic").sample(1, seed=2)
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or shutil.which("google-chrome") or ""
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--enable-unsafe-swiftshader",
        "--window-size=1200,800",
    ):
        options.add_argument(argument)
    driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "page.html"
            path.write_text(page([scene], "occlusion.scenic"), encoding="utf-8")
            driver.get(path.as_uri())
            for layer in ("views", "headings", "labels"):
                driver.execute_script(f"document.querySelector('[data-layer=\"{layer}\"]').click()")
            driver.execute_script("document.getElementById('whole').click()")
            time.sleep(2)
            return PIL.Image.open(io.BytesIO(base64.b64decode(driver.get_screenshot_as_base64())))
    finally:
        driver.quit()


if __name__ == "__main__":
    main()
