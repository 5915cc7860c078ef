"""Scenic in notebooks: what is shown, and the cell magic; run in a shell of IPython."""

from collections.abc import Iterator
from typing import Any

import pytest

import scenic

IPython = pytest.importorskip("IPython")
PROGRAM = "ego = new Object at (Range(0, 1), 0), with name_of_it '<b>'\n"


@pytest.fixture(scope="module")
def shell() -> Iterator[Any]:
    from IPython.core.interactiveshell import InteractiveShell
    from IPython.utils.capture import capture_output

    made = InteractiveShell.instance()
    with capture_output():
        made.run_line_magic("load_ext", "scenic")
    yield made
    InteractiveShell.clear_instance()


def shown(shell: Any, cell: str) -> list[dict[str, Any]]:
    """The data that a cell displays, and that of its value."""
    from IPython.utils.capture import capture_output

    with capture_output() as captured:
        result = shell.run_cell(cell)
    found = [output.data for output in captured.outputs]
    if result.result is not None:
        found.append(shell.display_formatter.format(result.result)[0])
    return found


def test_a_scene_shows_itself_without_the_extension() -> None:
    (scene,) = scenic.scenarioFromString(PROGRAM).sample(1, seed=1)
    bundle = scene._repr_mimebundle_()
    assert bundle["text/plain"] == "<Scene 0 of seed 1: 1 objects>"
    html = bundle["text/html"]
    assert '<iframe srcdoc="' in html
    assert 'src="data:image/png;base64,' in html  # what remains without frames
    assert "<script" not in html  # all of the page is quoted


def test_a_cell_is_compiled_sampled_and_shown(shell: Any) -> None:
    outputs = shown(shell, f"%%scenic room -n 3 --seed 4\n{PROGRAM}")
    assert "iframe" in outputs[-1]["text/html"]
    assert "0 of 3 scenes" in outputs[0]["text/html"]
    assert isinstance(shell.user_ns["room"], scenic.Scenario)
    same = scenic.scenarioFromString(PROGRAM, filename="<cell>").sample(3, seed=4)
    assert [scene.egoObject.position for scene in shell.user_ns["scenes"]] == [
        scene.egoObject.position for scene in same
    ]


def test_mistakes_are_explained(shell: Any) -> None:
    (output,) = shown(shell, "%%scenic\nego = new Object on <flor>")
    assert "error SC" in output["text/html"]
    assert "<flor>" not in output["text/html"]


def test_rejections_diagnostics_and_simulations_are_shown(shell: Any) -> None:
    shown(shell, f"%%scenic rare -n 0\n{PROGRAM}require ego.position.x ** 2 > 1.5")
    (report,) = shown(shell, "list(rare.stream(1, seed=1, max_attempts=50))[0]")
    assert "scene 0 was not found" in report["text/html"]
    (diagnostic,) = shown(shell, "import scenic; scenic.parse('ego = new').diagnostics[0]")
    assert "SC" in diagnostic["text/html"]
    shown(shell, f"%%scenic still -n 0\n{PROGRAM}require always ego.position.x >= 0 as 'right'")
    (row,) = shown(shell, "still.simulate(1, seed=1, simulator='dummy', max_steps=3, shown=True)[0]")
    assert "<td>right</td><td>presumably true</td>" in row["text/html"]
    assert "iframe" in row["text/html"]
    code = "from scenic.simulators.dummy import DummySimulator\n"
    code += "DummySimulator(drift=1).simulate(still.sample(1, seed=1)[0], maxSteps=3)"
    (simulation,) = shown(shell, code)
    assert "iframe" in simulation["text/html"]


def test_a_notebook_that_is_run_fails_with_the_diagnostic() -> None:
    nbclient = pytest.importorskip("nbclient")
    from nbformat.v4 import new_code_cell, new_notebook

    cells = ["%load_ext scenic", "%%scenic\nego = new Object at (Range(0, 1), 0), facing flor"]
    notebook = new_notebook(cells=[new_code_cell(cell) for cell in cells])
    with pytest.raises(nbclient.exceptions.CellExecutionError) as failure:
        nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    wanted = "error[SC202], line 1: the name `flor` is not defined"
    assert wanted in str(failure.value)
    shown_data, error = notebook.cells[1].outputs
    assert wanted in shown_data["data"]["text/plain"]
    assert "<b>error SC202</b>, line 1" in shown_data["data"]["text/html"]
    assert (error["output_type"], wanted in "\n".join(error["traceback"])) == ("error", True)
