"""Names of appearances, the property ``appearance`` of objects; checks of programs need these without drawing anything."""

from typing import Final

from scenic.language.spelling import nearest

__all__ = ["NAMES", "advice"]

NAMES: Final = ("car", "truck", "bus", "bicycle", "motorcycle", "pedestrian")


def advice(name: object) -> str:
    """Advice on the name to write in place of an unknown one."""
    meant = nearest(name, NAMES) if isinstance(name, str) else None
    if meant is not None:
        return f"did you mean '{meant}'?"
    return f"give one of {', '.join(map(repr, NAMES))}, or None to show the object's shape"
