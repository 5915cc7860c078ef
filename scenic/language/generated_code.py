"""The agreement between generated code and what runs it."""

from typing import Final

__all__ = ["PRELUDE"]

PRELUDE: Final = "__scenic__"
"""The global through which generated code reaches the runtime."""
