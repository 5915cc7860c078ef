"""Access to the modules that are generated from the grammar.

In an installed package they simply are there. In a checkout, where ``grammar/`` stands beside ``scenic/``, they are
compared with the grammar first, and made again if it has changed since.
"""

import importlib
import importlib.util
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

PACKAGE: Final = "scenic.compiler._generated"
MODULES: Final = ("context_free", "parser", "recording", "syntax", "tables")


def ensure_fresh(root: Path, folder: Path) -> bool:
    """Make the modules in ``folder`` again if they are missing or older than the grammar in ``root``.

    Returns whether it did. Several processes may do so at once: every file is replaced as a whole. Raises
    `ImportError` if they have to be made and cannot be.
    """
    grammar = root / "grammar" / "scenic.gram"
    if not (grammar.is_file() and (root / "grammar" / "generator").is_dir()):
        return False
    digest = _grammar_digest(root, grammar)
    if all(_has_digest(folder / f"{name}.py", digest) for name in MODULES):
        return False
    advice = "run `make generate` in the checkout"
    sys.path.insert(0, str(root))
    try:
        generate: Callable[[Path, Path], None] = importlib.import_module("grammar.generator").generate
    except ImportError as problem:
        raise ImportError(
            f"the parser in {folder} is missing or older than the grammar, and the generator cannot be "
            f"loaded ({problem}): {advice}"
        ) from problem
    finally:
        sys.path.remove(str(root))
    try:
        generate(grammar, folder)
    except OSError as problem:
        raise ImportError(f"the parser cannot be written to {folder} ({problem}): {advice}") from problem
    for name in MODULES:
        # A cached module of the same size and second would be taken for the new one.
        Path(importlib.util.cache_from_source(str(folder / f"{name}.py"))).unlink(missing_ok=True)
    importlib.invalidate_caches()
    return True


def _grammar_digest(root: Path, grammar: Path) -> str:
    """The digest that generated modules should carry; see ``grammar/digest.py``."""
    path = root / "grammar" / "digest.py"
    specification = importlib.util.spec_from_file_location("_scenic_grammar_digest", path)
    if specification is None or specification.loader is None:
        raise ImportError(f"{path} cannot be loaded")
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return str(module.grammar_digest(grammar))


def _has_digest(path: Path, digest: str) -> bool:
    try:
        with path.open(encoding="utf-8") as file:
            return f'GRAMMAR_HASH = "{digest}"' in file.read(400)
    except OSError:
        return False


ensure_fresh(Path(__file__).resolve().parents[2], Path(__file__).resolve().parent / "_generated")

_tables: Any = importlib.import_module(f"{PACKAGE}.tables")
_parser: Any = importlib.import_module(f"{PACKAGE}.parser")

GRAMMAR_HASH: Final[str] = _tables.GRAMMAR_HASH
"""Changes whenever the grammar or its generator does; part of the tag of cached code."""

WORDS: Final[Mapping[str, int]] = _tables.WORDS
HARD_KEYWORDS: Final[Mapping[str, int]] = _tables.HARD_KEYWORDS
SOFT_KEYWORDS: Final[Mapping[str, int]] = _tables.SOFT_KEYWORDS
OPERATORS: Final[Mapping[str, int]] = _tables.OPERATORS
KIND_NAMES: Final[Mapping[int, str]] = _tables.KIND_NAMES
STATEMENT_STARTERS: Final[frozenset[str]] = _tables.STATEMENT_STARTERS
INFIX_KINDS: Final[frozenset[int]] = _tables.INFIX_KINDS
SPECIFIER_KINDS: Final[frozenset[int]] = _tables.SPECIFIER_KINDS
LADDERS: Final[Mapping[str, tuple[tuple[str, int], ...]]] = _tables.LADDERS
FORMS: Final[tuple[tuple[Any, ...], ...]] = _tables.FORMS
SPECIFIER_FORMS: Final[tuple[tuple[Any, ...], ...]] = _tables.SPECIFIER_FORMS

build_parser: Final[Callable[..., Any]] = _parser.build


def syntax_rules() -> Mapping[str, tuple[Any, ...]]:
    """Return the rules of the grammar as data, for `scenic.compiler.syntax`."""
    module: Any = importlib.import_module(f"{PACKAGE}.syntax")
    rules: Mapping[str, tuple[Any, ...]] = module.RULES
    return rules


def context_free_rules() -> Mapping[str, tuple[Any, ...]]:
    """Return the rules without ordered choice, for `scenic.constrained`."""
    module: Any = importlib.import_module(f"{PACKAGE}.context_free")
    rules: Mapping[str, tuple[Any, ...]] = module.RULES
    return rules


def build_recording_parser(*arguments: Any) -> Any:
    """Return the parser that notes how far it came; loaded only when there is a mistake to explain."""
    module: Any = importlib.import_module(f"{PACKAGE}.recording")
    return module.build(*arguments)
