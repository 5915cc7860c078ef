"""The layers import only downwards: the invariants of ARCHITECTURE.md, read off the import statements."""

import ast
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "scenic"

LAYERS = {
    "language": set(),
    "compiler": {"language"},
    "graph": set(),
    "runtime": {"graph", "language"},
    "analysis": {"graph", "runtime", "language", "compiler"},
    "assessment": {"analysis", "formats", "runtime", "graph", "language"},
    "formats": {"runtime", "graph", "language"},
    "simulators": {"runtime", "graph", "language", "formats", "domains"},
    "domains": {"runtime", "graph", "language", "formats", "simulators"},
    "batch": {"simulators", "formats", "runtime", "graph", "language"},
    "statistics": set(),
    "falsification": {"batch", "simulators", "formats", "runtime", "graph", "language", "statistics"},
    "estimation": {
        "falsification",
        "batch",
        "simulators",
        "formats",
        "runtime",
        "graph",
        "language",
        "statistics",
    },
    "configuration": {"language"},
    "project": {"language", "compiler", "configuration", "formats"},  # of formats, the reader of maps alone
    "migration": {"compiler", "language", "project", "formats"},  # of formats, the writing of files alone
    "ide": {"compiler", "language", "project", "migration"},
    "lsp": {
        "ide",
        "language",
        "configuration",
        "project",
        "compiler",
    },  # of the compiler, the semantic model alone
    "playground": {"ide"},
    "templates": set(),
    "deep": {"analysis", "formats", "runtime", "graph", "language", "compiler"},
    "constrained": {
        "compiler",
        "language",
        "project",
        "simulators",
    },  # of simulators, the list of blueprints alone
    "mcp_server": {"constrained", "migration", "domains", "ide", "language", "compiler", "project"},
    "trying": {"batch", "domains", "formats", "runtime", "graph", "language", "compiler", "project"},
    "cli": {
        "templates",
        "trying",
        "constrained",
        "mcp_server",
        "deep",
        "assessment",
        "domains",
        "batch",
        "estimation",
        "falsification",
        "statistics",
        "formats",
        "runtime",
        "graph",
        "language",
        "compiler",
        "configuration",
        "project",
        "migration",
        "ide",
        "lsp",
        "playground",
    },
}
"""What each layer may import of the others."""

ROOMS = {
    "scenic.runtime": (
        "ground",
        "geometry",
        "temporal",
        "values",
        "python",
        "shapes",
        "regions",
        "instances",
        "elements",
        "description",
        "dynamics",
        "program",
        "sampling",
        "scenes",
    ),
    "scenic.runtime.geometry": ("meshes", "flat", "contact", "containment", "views"),
}
"""Rooms of a package from the bottom up: each imports only those before it; modules beside the rooms are below all of them."""

LIBRARIES = {
    "language": set(),
    "compiler": set(),
    "configuration": set(),
    "graph": {"numpy", "scipy"},
    "project": set(),
    "migration": set(),
    "ide": {"pygments"},
    "lsp": {"pygls", "lsprotocol", "cattrs", "websockets"},
    "playground": {"websockets"},
}
"""Libraries of each layer beside the standard library; layers left out may use any dependency."""

ONLY_IN = {
    "embreex": {"runtime", "formats"},
    "z3": {"analysis"},
    "websockets": {"playground", "lsp"},
    "pygls": {"lsp"},
    "lsprotocol": {"lsp"},
    "mcp": {"mcp_server"},
    "anyio": {"mcp_server"},
    "cattrs": {"lsp"},
    "click": {"cli"},
    "rich": {"cli"},
    "mujoco": {"simulators"},
}
"""Libraries that only some layers may know."""

HEAVY = {"scipy", "trimesh", "z3", "embreex", "shapely", "manifold3d", "PIL", "networkx"}
HEAVY |= {"mujoco", "pyarrow", "imageio_ffmpeg", "cma", "optuna", "sklearn"}
"""Libraries that may not be imported when a module is."""


def modules() -> Iterator[tuple[str, Path]]:
    for path in sorted(PACKAGE.rglob("*.py")):
        if "_generated" not in path.parts:
            yield ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"), path


def imports(module: str, *, at_start: bool = False) -> Iterator[str]:
    """Names of modules that a module imports: everywhere in it, or only when it is itself imported."""
    for node in _statements(trees()[module], at_start):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}:{node.lineno}: relative import"
            assert node.module is not None
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _statements(tree: ast.AST, at_start: bool) -> Iterator[ast.AST]:
    waiting = [tree]
    while waiting:
        for node in ast.iter_child_nodes(waiting.pop()):
            # No expression has an import.
            if not isinstance(node, ast.stmt | ast.excepthandler | ast.match_case):
                continue
            if at_start and isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                continue
            if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
                continue
            yield node
            waiting.append(node)


def layer(module: str) -> str | None:
    parts = module.split(".")
    return parts[1] if parts[0] == "scenic" and len(parts) > 1 and (PACKAGE / parts[1]).is_dir() else None


ALL = dict(modules())


# Not when this module is imported, which every worker does.


@cache
def trees() -> dict[str, ast.Module]:
    return {module: ast.parse(path.read_text(encoding="utf-8")) for module, path in ALL.items()}


@cache
def all_imports() -> dict[str, frozenset[str]]:
    return {module: frozenset(imports(module)) for module in ALL}


def test_layers_import_downwards() -> None:
    wrong = [
        f"{module} imports {name}"
        for module, names in all_imports().items()
        if (own := layer(module)) in LAYERS
        for name in names
        if layer(name) not in (None, own, *LAYERS[own])
    ]
    assert not wrong


@pytest.mark.parametrize("package", ROOMS)
def test_rooms_import_downwards(package: str) -> None:
    rooms = ROOMS[package]
    folder = ROOT.joinpath(*package.split("."))
    assert {path.parent.name for path in folder.glob("*/__init__.py")} == set(rooms)

    def floor(module: str) -> int:
        rest = module.removeprefix(f"{package}.")
        name = rest.partition(".")[0]
        return rooms.index(name) if rest != module and name in rooms else -1

    wrong = [
        f"{module} imports {name}"
        for module, names in all_imports().items()
        if module.startswith(f"{package}.")
        for name in names
        if floor(name) > floor(module)
    ]
    assert not wrong


def test_the_semantic_model_knows_no_rule() -> None:
    rooms = {
        name: names for name, names in all_imports().items() if name.startswith("scenic.compiler.semantics")
    }
    assert rooms
    wrong = [
        f"{module} imports {name}"
        for module, names in rooms.items()
        for name in names
        if name.startswith(("scenic.compiler.checks", "scenic.compiler.resolver", "scenic.compiler.compile"))
    ]
    assert not wrong


def test_only_commands_and_the_api_call_the_pipeline() -> None:
    joins = [
        module
        for module, names in all_imports().items()
        if (own := layer(module)) in LAYERS
        and own not in ("cli", "deep", "trying")
        and "scenic.pipeline" in names
    ]
    assert not joins


def test_layers_keep_their_libraries() -> None:
    wrong = [
        f"{module} imports {name}"
        for module, names in all_imports().items()
        for name in {name.partition(".")[0] for name in names} - {"scenic"} - sys.stdlib_module_names
        if ((own := layer(module)) in LIBRARIES and name not in LIBRARIES[own])
        or own not in ONLY_IN.get(name, {own})
    ]
    assert not wrong


def test_heavy_libraries_are_imported_where_they_are_used() -> None:
    early = [
        f"{module} imports {name}"
        for module in ALL
        for name in imports(module, at_start=True)
        if name.partition(".")[0] in HEAVY
    ]
    assert not early


def test_there_are_no_import_cycles() -> None:
    edges = {
        module: {name for name in names if name in ALL and name != module}
        for module, names in all_imports().items()
    }
    done: set[str] = set()

    def visit(module: str, trail: tuple[str, ...]) -> None:
        assert module not in trail, " -> ".join((*trail[trail.index(module) :], module))
        if module in done:
            return
        for name in sorted(edges[module]):
            # A package's own __init__ is imported before its modules: that is no cycle.
            if not module.startswith(f"{name}."):
                visit(name, (*trail, module))
        done.add(module)

    for module in edges:
        visit(module, ())


def test_no_module_fills_in_the_classes_of_others() -> None:
    """A cycle of imports that was moved into an assignment is a cycle still."""
    found = []
    for module, tree in trees().items():
        imported = {
            (alias.asname or alias.name).partition(".")[0]
            for node in tree.body
            if isinstance(node, ast.Import | ast.ImportFrom)
            for alias in node.names
        }
        found += [
            f"{module} fills in {name}" for node in _at_import(tree) if (name := _filled_in(node)) in imported
        ]
    assert not found


def _at_import(tree: ast.AST) -> Iterator[ast.AST]:
    """What runs when a module is imported."""
    for node in ast.iter_child_nodes(tree):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            yield node
            yield from _at_import(node)


def _filled_in(node: ast.AST) -> str | None:
    """The name that a node gives an attribute: ``A.x = 1``, ``A.x[y] = 1``, ``vars(A)[x] = 1``, ``setattr(A, ...)``."""
    if isinstance(node, ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store):
        owner: ast.AST = node.value
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "setattr":
        owner = node.args[0]
    else:
        return None
    while not isinstance(owner, ast.Name):
        if isinstance(owner, ast.Attribute | ast.Subscript):
            owner = owner.value
        elif isinstance(owner, ast.Call) and owner.args:
            owner = owner.args[0]
        else:
            return None
    return owner.id


CHANGING = {"append", "extend", "insert", "add", "update", "setdefault", "pop", "popitem", "clear", "remove"}


def test_no_module_has_mutable_state() -> None:
    """Nothing that a module binds is changed by its functions: no ``global``, no change of a module's container."""
    found = []
    for module, tree in trees().items():
        containers = {
            target.id
            for node in tree.body
            if isinstance(node, ast.Assign | ast.AnnAssign)
            for target in getattr(node, "targets", [getattr(node, "target", None)])
            if isinstance(target, ast.Name)
        }
        for function in ast.walk(tree):
            if not isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
                continue
            for node in ast.walk(function):
                if isinstance(node, ast.Global):
                    found.append(f"{module}:{node.lineno}: global")
                name = _changed(node)
                if name in containers and name not in _locals(function):
                    found.append(f"{module}:{node.lineno}: changes {name}")
    assert not found


def _changed(node: ast.AST) -> str | None:
    """The name of the container that a node changes in place."""
    if isinstance(node, ast.Subscript | ast.Attribute) and isinstance(node.ctx, ast.Store | ast.Del):
        return node.value.id if isinstance(node.value, ast.Name) else None
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in CHANGING:
        return node.func.value.id if isinstance(node.func.value, ast.Name) else None
    return None


def _locals(function: ast.AST) -> set[str]:
    stored = {
        node.id
        for node in ast.walk(function)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    return stored | {node.arg for node in ast.walk(function) if isinstance(node, ast.arg)}


LONGEST = 700
"""Lines of a module, at most: a longer one has more than one idea."""


def test_modules_are_not_too_long() -> None:
    lengths = {module: path.read_text(encoding="utf-8").count("\n") for module, path in ALL.items()}
    assert not {module: length for module, length in lengths.items() if length > LONGEST}


INDIRECT = {"What", "Which", "Who", "Whose", "How", "Why", "That", "Those", "Whether", "Where"}
"""Words that no docstring begins with: it begins with a noun (what it is) or a verb (what it does)."""

BESIDE = ("grammar", "fuzz", "benchmarks", "editors", "examples", "docs")
"""Folders, beside the package, whose docstrings people read."""


def test_docstrings_begin_with_a_noun_or_a_verb() -> None:
    scripts = [path for folder in BESIDE for path in sorted((ROOT / folder).rglob("*.py"))]
    all_trees = trees() | {str(path): ast.parse(path.read_text(encoding="utf-8")) for path in scripts}
    found = [
        f"{module}:{line}: {text[:60]}"
        for module, tree in all_trees.items()
        for line, text in _docstrings(tree)
        if text.split(maxsplit=1)[:1] and text.split(maxsplit=1)[0] in INDIRECT
    ]
    assert not found


def _docstrings(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and text of every string that is a statement: docstrings, private ones too, and texts below an assignment."""
    for node in ast.walk(tree):
        match node:
            case ast.Expr(value=ast.Constant(value=str(text))):
                yield node.lineno, text


def test_a_static_check_loads_no_numpy() -> None:
    import subprocess

    program = (
        "import sys, scenic; scenic.parse('ego = new Object'); "
        "sys.exit('numpy' in sys.modules or 'rich' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=False).returncode == 0
