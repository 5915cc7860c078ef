"""Blocks of Scenic in pages: highlighted, and with the flag ``draw`` followed by a picture of what the program makes.

``page`` adds a link to a page in which the scenes can be turned. See `running` for the other flags.
"""

import shutil
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from docs._extensions.blocks import options_of
from docs._extensions.drafts import IS_DRAFT
from docs._extensions.pictures import Shot, kept_page, kept_picture
from docs._extensions.running import Programs, workplace

BUILD = Path(__file__).parents[1] / "_build"
PICTURES = BUILD / ("drafts" if IS_DRAFT else "pictures")
PAGES = BUILD / "scenes"


class ScenicBlock(SphinxDirective):
    """A code block of Scenic."""

    has_content = True
    optional_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """Return the code, and a picture if the block's options request it."""
        code = "\n".join(self.content) + "\n"
        options = options_of(self.arguments[0]) if self.arguments else {}
        program = "\n".join(self.content)
        block = nodes.literal_block(program, program, language="scenic")
        self.set_source_info(block)
        programs = self.env.temp_data.setdefault("scenic_programs", Programs())
        if "fragment" in options:
            return [block]
        programs.text(code, options)
        if "draw" not in options:
            return [block]
        with tempfile.TemporaryDirectory() as folder, workplace(Path(folder)):
            programs.write(Path(folder))
            shot = Shot.of(Path(folder) / f"{options.get('name', 'program')}.scenic", options)
            return [block, *self._shown(shot, options)]

    def _shown(self, shot: Shot, options: dict[str, str]) -> list[nodes.Node]:
        picture = kept_picture(shot, PICTURES)
        what = (
            "Moments of a simulation"
            if shot.steps
            else "A scene"
            if shot.count == 1
            else f"{shot.count} scenes"
        )
        image: nodes.Node = nodes.image(
            uri=f"/_build/{PICTURES.name}/{picture.name}",
            alt=f"{what} of this program",
            classes=["scene"] if shot.count == 1 else [],
        )
        page_nodes: list[nodes.Node] = [
            image if shot.count == 1 else nodes.container("", image, classes=["scenes"])
        ]
        if "page" in options:
            page = kept_page(shot, PAGES, f"{shot.path.stem}: {what.lower()}")
            page_names = self.env.metadata[self.env.docname].setdefault("scenic_pages", "")
            self.env.metadata[self.env.docname]["scenic_pages"] = f"{page_names} {page.name}"
            up = "../" * self.env.docname.count("/")
            link = nodes.raw(
                "",
                f'<p class="turn"><a href="{up}scenes/{page.name}">Turn it in three dimensions</a></p>',
                format="html",
            )
            page_nodes.append(link)
        return page_nodes


class CameraImage(SphinxDirective):
    """Images from a camera of a program above: ``PROGRAM CAMERA seed=1 count=1``."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """Return the images, side by side."""
        program, camera, *rest = self.arguments[0].split()
        options = options_of(" ".join(rest))
        with tempfile.TemporaryDirectory() as folder, workplace(Path(folder)):
            self.env.temp_data["scenic_programs"].write(Path(folder))
            shot = Shot.of(Path(folder) / f"{program}.scenic", {**options, "draw": options.get("count", "1")})
            image = kept_picture(replace(shot, camera=camera), PICTURES)
        return [
            nodes.image(uri=f"/_build/{PICTURES.name}/{image.name}", alt=f"Images of the camera {camera}")
        ]


def _copy_pages(app: Sphinx, exception: Exception | None) -> None:
    if exception is None and app.builder.name == "html":
        used = {name for data in app.env.metadata.values() for name in data.get("scenic_pages", "").split()}
        target = Path(app.outdir) / "scenes"
        shutil.rmtree(target, ignore_errors=True)
        target.mkdir()
        for name in used:
            shutil.copy(PAGES / name, target / name)


def setup(app: Sphinx) -> dict[str, Any]:
    """Take blocks of Scenic over from the highlighter."""
    from scenic.ide.pygments_lexer import ScenicLexer

    app.add_lexer("scenic", ScenicLexer)
    app.add_directive("scenic", ScenicBlock)
    app.add_directive("camera", CameraImage)
    app.connect("build-finished", _copy_pages)
    return {"version": "1", "parallel_read_safe": True}
