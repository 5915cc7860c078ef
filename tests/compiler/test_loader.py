"""Finding, compiling and caching modules."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from scenic.compiler import compile as compiling
from scenic.compiler import loader
from scenic.compiler.loader import ScenicLoader, cache_file, find_module, load_code, program_code
from scenic.language.errors import ScenicError, ScenicSyntaxError
from scenic.language.source import Source


def value(path: Path) -> object:
    scope: dict[str, object] = {}
    exec(load_code(path), scope)
    return scope["x"]


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "room.scenic"
    path.write_text("x = 1\n", encoding="utf-8")
    return path


@pytest.fixture
def compilations(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The files that are compiled while the test runs."""
    done: list[str] = []
    compile_text = compiling.compile_text

    def noted(text: str, *, filename: str) -> object:
        done.append(filename)
        return compile_text(text, filename=filename)

    monkeypatch.setattr(compiling, "compile_text", noted)
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    return done


def test_find_module(tmp_path: Path) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    files = [
        "first/a.sc",
        "second/a.scenic",
        "second/b.scenic",
        "second/b.sc",
        "second/p/__init__.scenic",
        "second/p/q.sc",
    ]
    for name in [*files, "second/c.py"]:
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("")
    (second / "folder.scenic").mkdir()
    path = [str(first), second, tmp_path / "missing"]
    assert find_module("a", path) == first / "a.sc"
    assert find_module("b", path) == second / "b.scenic"
    assert find_module("p", path) == second / "p" / "__init__.scenic"
    assert find_module("p.q", path) == second / "p" / "q.sc"
    for name in ("c", "folder", "p.r", "missing", "", "..a", "a.", "../second/b", "p/q"):
        assert find_module(name, path) is None, name


def test_code_is_cached_apart_from_python(program: Path, compilations: list[str]) -> None:
    program.with_suffix(".py").write_text("x = 2\n")
    assert value(program) == 1
    assert value(program) == 1
    assert compilations == [str(program)]
    [kept] = (program.parent / "__pycache__").iterdir()
    assert kept == cache_file(str(program))
    assert kept.name.startswith("room.scenic.")
    assert sys.implementation.cache_tag in kept.name
    assert "room" not in sys.modules


@pytest.mark.parametrize("keep_times", [False, True])
def test_a_changed_source_is_compiled_again(program: Path, compilations: list[str], keep_times: bool) -> None:
    assert value(program) == 1
    before = program.stat()
    program.write_text("x = 3\n", encoding="utf-8")
    if keep_times:
        # Same size, same time: an edit within the resolution of the file system's clock.
        os.utime(program, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert value(program) == 3
    assert len(compilations) == 2


@pytest.mark.parametrize("damage", ["empty", "short", "flipped", "foreign", "folder"])
def test_a_damaged_cache_is_ignored(program: Path, compilations: list[str], damage: str) -> None:
    load_code(program)
    kept = cache_file(str(program))
    assert kept is not None
    data = kept.read_bytes()
    if damage == "empty":
        kept.write_bytes(b"")
    elif damage == "short":
        kept.write_bytes(data[:-5])
    elif damage == "flipped":
        middle = len(data) - 10
        kept.write_bytes(data[:middle] + bytes([data[middle] ^ 255]) + data[middle + 1 :])
    elif damage == "foreign":
        kept.write_bytes(b"\0" * len(data))
    else:
        kept.unlink()
        kept.mkdir()
    assert value(program) == 1
    assert len(compilations) == 2
    if damage != "folder":
        assert kept.read_bytes() == data
        assert value(program) == 1
        assert len(compilations) == 2
    assert [file.name for file in kept.parent.iterdir()] == [kept.name]


def test_a_moved_program_names_its_new_place(program: Path, compilations: list[str]) -> None:
    load_code(program)
    moved = program.parent / "elsewhere"
    moved.mkdir()
    program.rename(moved / program.name)
    (program.parent / "__pycache__").rename(moved / "__pycache__")
    assert load_code(moved / program.name).co_filename == str(moved / program.name)


def test_no_cache_where_none_is_wanted(
    program: Path, compilations: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert value(program) == 1
    assert not (program.parent / "__pycache__").exists()


def test_a_cache_folder_of_its_own(
    program: Path, compilations: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    prefix = program.parent / "prefix"
    monkeypatch.setattr(sys, "pycache_prefix", str(prefix))
    assert value(program) == 1
    assert not (program.parent / "__pycache__").exists()
    [kept] = [file for file in prefix.rglob("*") if file.is_file()]
    assert kept == cache_file(str(program))


def test_nothing_can_be_written(program: Path, compilations: list[str]) -> None:
    # A file where the folder should be: no permission of the user helps.
    (program.parent / "__pycache__").write_text("")
    assert value(program) == 1
    assert (program.parent / "__pycache__").read_text() == ""


def test_another_compiler_does_not_see_the_cache(
    program: Path, compilations: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    load_code(program)
    monkeypatch.setattr(loader, "_fingerprint", lambda: "0123456789abcdef")
    load_code(program)
    assert len(compilations) == 2
    assert len(list((program.parent / "__pycache__").iterdir())) == 2


def test_errors_hold_every_diagnostic(tmp_path: Path) -> None:
    path = tmp_path / "bad.scenic"
    path.write_text("new Object with widht 3\nx = Rnage(1)\ny = Unifrom(1)\n")
    with pytest.raises(ScenicSyntaxError) as caught:
        load_code(path)
    assert [item.code for item in caught.value.diagnostics] == ["SC202", "SC202", "SC300"]
    assert caught.value.filename == str(path)
    assert caught.value.line == 2
    assert not (tmp_path / "__pycache__").exists()


def test_unreadable_files(tmp_path: Path) -> None:
    with pytest.raises(ScenicError) as caught:
        load_code(tmp_path / "missing.scenic")
    assert caught.value.code == "SC600"
    binary = tmp_path / "binary.scenic"
    binary.write_bytes(b"x = '\xff'\n")
    with pytest.raises(ScenicError) as caught:
        load_code(binary)
    assert caught.value.code == "SC107"


def test_as_an_importlib_loader(program: Path) -> None:
    from importlib.util import module_from_spec, spec_from_file_location

    found = ScenicLoader("room", str(program))
    spec = spec_from_file_location("room", program, loader=found)
    assert spec is not None
    module = module_from_spec(spec)
    found.exec_module(module)
    assert module.x == 1
    assert found.get_source("room") == "x = 1\n"
    assert "room" not in sys.modules


def test_programs_of_commands_are_kept_in_a_private_folder(tmp_path: Path, compilations: list[str]) -> None:
    source, folder = Source("x = 1\n", str(tmp_path / "room.scenic")), tmp_path / "store"
    code = program_code(source, folder)
    assert program_code(source, folder) == code
    assert len(compilations) == 1
    assert [file.suffix for file in folder.iterdir()] == [".program"]
    assert {file.name for file in tmp_path.iterdir()} == {"store"}
    program_code(Source("x = 2\n", source.filename), folder)
    program_code(Source(source.text, str(tmp_path / "other.scenic")), folder)
    assert len(compilations) == 3
    for file in folder.iterdir():
        file.write_bytes(file.read_bytes()[:-1] + b"?")
    assert program_code(source, folder) == code
    folder.chmod(0o777)
    program_code(source, folder)
    program_code(source, None)
    assert len(compilations) == 6


def test_wrong_programs_are_not_kept(tmp_path: Path, compilations: list[str]) -> None:
    for _ in range(2):
        with pytest.raises(ScenicSyntaxError):
            program_code(Source("new\n", "room.scenic"), tmp_path / "store")
    assert len(compilations) == 2
    assert not list((tmp_path / "store").iterdir())


def test_a_kept_program_is_sampled_without_the_compiler(tmp_path: Path) -> None:
    path = tmp_path / "room.scenic"
    path.write_text("ego = new Object at (Normal(0, 1), 0)\n")
    script = (
        "import sys, scenic; scene, = scenic.load(sys.argv[1]).sample(1, seed=1); "
        "print(scene.egoObject.x, *sorted({'scenic.compiler.compile', 'scipy.special', 'scipy.stats'} & set(sys.modules)))"
    )
    environment = {
        name: value
        for name, value in os.environ.items()
        if name not in ("SCENIC_CACHE", "PYTHONDONTWRITEBYTECODE")
    }
    environment["SCENIC_CACHE_DIR"] = str(tmp_path / "cache")
    first, second = (
        subprocess.run(
            [sys.executable, "-c", script, str(path)],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()
        for _ in range(2)
    )
    assert first[1:] == ["scenic.compiler.compile"]
    assert second == first[:1]
