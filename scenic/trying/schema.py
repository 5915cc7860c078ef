"""The JSON schema of an answer (`scenic.trying.answer`)."""

from collections.abc import Mapping
from typing import Any, Final

from scenic.language.diagnostics import Severity
from scenic.trying.answer import PHASES, VERSION

__all__ = ["DIAGNOSTIC", "SCHEMA"]

_TEXT: Final = {"type": "string"}
_TEXT_OR_NULL: Final = {"type": ["string", "null"]}
_COUNT: Final = {"type": "integer", "minimum": 0}
_POSITION: Final = {"type": "integer", "minimum": 1}


def _object(properties: Mapping[str, object], *, optional: tuple[str, ...] = ()) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": dict(properties),
        "required": [name for name in properties if name not in optional],
        "additionalProperties": False,
    }


def _or_null(schema: Mapping[str, object]) -> dict[str, Any]:
    return {"anyOf": [dict(schema), {"type": "null"}]}


def _list(items: Mapping[str, object]) -> dict[str, Any]:
    return {"type": "array", "items": dict(items)}


_SPAN: Final = _object(dict.fromkeys(("line", "column", "end_line", "end_column"), _POSITION))
_FIX: Final = _object({"title": _TEXT, "edits": _list(_object({"span": _SPAN, "text": _TEXT}))})

DIAGNOSTIC: Final = _object(
    {
        "code": {"type": "string", "pattern": "^SC[0-9]{3}$"},
        "severity": {"enum": [each.value for each in Severity]},
        "title": _TEXT,
        "message": _TEXT,
        "help": _TEXT_OR_NULL,
        "page": _TEXT,
        "filename": _TEXT_OR_NULL,
        "span": _or_null(_SPAN),
        "labels": _list(_object({"span": _SPAN, "text": _TEXT, "filename": _TEXT}, optional=("filename",))),
        "fix": _or_null(_FIX),
    }
)
"""A diagnostic: lines and columns count from 1, columns in characters; ends are exclusive."""

_REJECTIONS: Final = _object(
    {
        "reason": {"enum": ["attempts", "time", "impossible"]},
        "candidates": _COUNT,
        "requirements": _list(
            _object(
                {
                    "label": _TEXT,
                    "span": _or_null(_SPAN),
                    "rejects": {"type": "number", "minimum": 0, "maximum": 1},
                    "alone": {"type": "number", "minimum": 0, "maximum": 1},
                    "note": _TEXT_OR_NULL,
                }
            )
        ),
    }
)
_SIMULATION: Final = _object(
    {
        "steps": _COUNT,
        "reason": _TEXT_OR_NULL,
        "rejections": _list(_object({"reason": _TEXT, "tries": _COUNT})),
        "requirements": _list(
            _object({"label": _TEXT, "verdict": _TEXT_OR_NULL, "robustness": {"type": ["number", "null"]}})
        ),
    }
)
_MAP: Final = _object(
    {
        "file": _TEXT,
        **dict.fromkeys(("roads", "lanes", "intersections", "sidewalks", "crossings", "shoulders"), _COUNT),
    },
    optional=("roads", "lanes", "intersections", "sidewalks", "crossings", "shoulders"),
)

SCHEMA: Final[Mapping[str, Any]] = {
    "$schema": "http://json-schema.org/draft-07/schema#",
    "title": "The answer of scenic try --json",
    "description": "The phase that a program reaches, all diagnostics, the first scene and a simulation.",
    **_object(
        {
            "version": {"const": VERSION},
            "file": _TEXT,
            "phase": {"enum": list(PHASES)},
            "ok": {"type": "boolean"},
            "diagnostics": _list(DIAGNOSTIC),
            "draws": _list(_object({"name": _TEXT, "line": {"type": ["integer", "null"]}})),
            "rejections": _or_null(_REJECTIONS),
            "map": _or_null(_MAP),
            "scene": {"type": ["object", "null"], "description": "A scene as in scene.schema.json."},
            "scenes": _list({"type": "object", "description": "All scenes, if several are wanted."}),
            "simulation": _or_null(_SIMULATION),
            "time": {"type": "object", "additionalProperties": {"type": "number", "minimum": 0}},
            "output": {**_TEXT, "description": "The beginning of what the program printed."},
        },
        optional=("output", "scenes"),
    ),
}
"""The schema of one answer."""
