from pathlib import Path

import pytest

from scenic.compiler.semantics.modules import ModuleKind
from scenic.project.module_search import ModuleFinder
from tests.project.layouts import write


@pytest.fixture
def finder(tmp_path: Path) -> ModuleFinder:
    write(
        tmp_path,
        {
            "main.scenic": "",
            "beside.scenic": "",
            "both.scenic": "",
            "both.py": "",
            "old.sc": "",
            "helper.py": "",
            "lib/inner.scenic": "",
            "lib/__init__.scenic": "",
            "lib/deep/far.py": "",
            "package/__init__.py": "",
            "package/part.py": "",
            "spaces/one.py": "",
            "elsewhere/given.scenic": "",
            "hidden-name/x.scenic": "",
        },
    )
    return ModuleFinder([str(tmp_path)], [str(tmp_path / "elsewhere")], ())


@pytest.mark.parametrize(
    ("name", "kind", "file"),
    [
        ("beside", ModuleKind.SCENIC, "beside.scenic"),
        ("both", ModuleKind.SCENIC, "both.scenic"),
        ("old", ModuleKind.SCENIC, "old.sc"),
        ("helper", ModuleKind.PYTHON, "helper.py"),
        ("lib", ModuleKind.SCENIC, "lib/__init__.scenic"),
        ("lib.inner", ModuleKind.SCENIC, "lib/inner.scenic"),
        ("lib.deep", ModuleKind.NAMESPACE, "lib/deep"),
        ("lib.deep.far", ModuleKind.PYTHON, "lib/deep/far.py"),
        ("package", ModuleKind.PYTHON, "package/__init__.py"),
        ("package.part", ModuleKind.PYTHON, "package/part.py"),
        ("spaces", ModuleKind.NAMESPACE, "spaces"),
        ("given", ModuleKind.SCENIC, "elsewhere/given.scenic"),
    ],
)
def test_modules_are_found(
    finder: ModuleFinder, tmp_path: Path, name: str, kind: ModuleKind, file: str
) -> None:
    found = finder.find(name, importer=str(tmp_path / "main.scenic"))
    assert (found.kind, found.filename) == (kind, str(tmp_path / file))


def test_modules_of_the_folders_above_are_found_up_to_the_root(finder: ModuleFinder, tmp_path: Path) -> None:
    assert finder.find("beside", importer=str(tmp_path / "lib" / "inner.scenic")).filename is not None
    inner = ModuleFinder([str(tmp_path / "spaces")], (), ())
    assert inner.find("beside", importer=str(tmp_path / "spaces" / "main.scenic")).is_missing


@pytest.mark.parametrize("roots", [(), ("package",)])
def test_modules_of_a_package_find_it(tmp_path: Path, roots: tuple[str, ...]) -> None:
    write(
        tmp_path,
        {"package/__init__.py": "", "package/part.scenic": "", "plain/one.scenic": "", "top.scenic": ""},
    )
    finder = ModuleFinder([str(tmp_path / root) for root in roots], (), ())
    within = str(tmp_path / "package/main.scenic")
    assert finder.find("package.part", importer=within).filename == str(tmp_path / "package/part.scenic")
    assert finder.find("top", importer=str(tmp_path / "plain/one.scenic")).is_missing


def test_dots_lead_to_the_folder_and_those_above(finder: ModuleFinder, tmp_path: Path) -> None:
    importer = str(tmp_path / "lib" / "deep" / "far.py")
    assert finder.find("far", importer=importer, level=1).kind is ModuleKind.PYTHON
    assert finder.find("inner", importer=importer, level=2).kind is ModuleKind.SCENIC
    assert finder.find("beside", importer=importer, level=1).is_missing
    assert finder.find("", importer=str(tmp_path / "package" / "part.py"), level=1).filename == str(
        tmp_path / "package" / "__init__.py"
    )


def test_what_is_missing_says_where_it_was_looked_for(finder: ModuleFinder, tmp_path: Path) -> None:
    found = finder.find("besides", importer=str(tmp_path / "main.scenic"))
    assert found.is_missing
    assert (found.near, found.found) == ("beside", "")
    assert found.searched == (str(tmp_path), str(tmp_path / "elsewhere"))
    inner = finder.find("lib.iner", importer=str(tmp_path / "main.scenic"))
    assert (inner.near, inner.found, inner.searched) == ("lib.inner", "lib", (str(tmp_path / "lib"),))


def test_pythons_own_modules_are_found(tmp_path: Path) -> None:
    finder = ModuleFinder([str(tmp_path)])
    importer = str(tmp_path / "main.scenic")
    assert finder.find("sys", importer=importer).kind is ModuleKind.COMPILED
    assert finder.find("os.path", importer=importer).kind is ModuleKind.COMPILED
    assert finder.find("json.decoder", importer=importer).kind is ModuleKind.PYTHON
    assert finder.find("scenic.language.names", importer=importer).kind is ModuleKind.PYTHON
    assert finder.find("jsn", importer=importer).near == "json"


def test_new_files_are_seen_after_forgetting(finder: ModuleFinder, tmp_path: Path) -> None:
    importer = str(tmp_path / "main.scenic")
    assert finder.find("fresh", importer=importer).is_missing
    (tmp_path / "fresh.scenic").touch()
    assert finder.find("fresh", importer=importer).is_missing
    finder.forget()
    assert not finder.find("fresh", importer=importer).is_missing


def test_what_can_be_imported(finder: ModuleFinder, tmp_path: Path) -> None:
    assert {
        "beside",
        "both",
        "old",
        "helper",
        "lib",
        "package",
        "spaces",
        "given",
        "json",
    } <= finder.importable(str(tmp_path))
    assert "hidden-name" not in finder.importable(str(tmp_path))
    assert finder.importable(str(tmp_path), "lib") == {"inner", "deep"}
