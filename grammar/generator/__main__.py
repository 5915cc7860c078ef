"""``python -m grammar.generator``: regenerates ``scenic/compiler/_generated``."""

import sys
from pathlib import Path

from grammar.generator import GrammarError, generate

ROOT = Path(__file__).resolve().parents[2]


def main() -> int:
    """Generate; a wrong grammar gives a message and exit code 1."""
    try:
        generate(ROOT / "grammar" / "scenic.gram", ROOT / "scenic" / "compiler" / "_generated")
    except GrammarError as problem:
        print(f"grammar/scenic.gram: {problem}", file=sys.stderr)  # noqa: T201 - a command prints
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
