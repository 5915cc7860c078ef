import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.formats.json_lines import plain, scene_line
from tests.formats.stand_ins import BALL, CYLINDER, Chair, Object, Scene, Turn

DOCS = Path(__file__).parents[2] / "docs" / "reference"
SCHEMA = json.loads((DOCS / "scene.schema.json").read_text())


def conforms(value: Any, schema: dict[str, Any]) -> bool:
    """Whether a value follows a schema, for the words of JSON Schema that ours uses."""
    known = {
        "object": isinstance(value, dict),
        "array": isinstance(value, list),
        "string": isinstance(value, str),
        "null": value is None,
        "boolean": isinstance(value, bool),
        "integer": isinstance(value, int) and not isinstance(value, bool),
        "number": isinstance(value, int | float) and not isinstance(value, bool),
    }
    for word, argument in schema.items():
        match word:
            case "$schema" | "title" | "$defs":
                fine = True
            case "$ref":
                fine = conforms(value, SCHEMA["$defs"][argument.removeprefix("#/$defs/")])
            case "type":
                fine = known[argument]
            case "const":
                fine = value == argument and type(value) is type(argument)
            case "enum":
                fine = value in argument
            case "anyOf":
                fine = any(conforms(value, option) for option in argument)
            case "required":
                fine = all(name in value for name in argument)
            case "properties":
                fine = all(conforms(value[name], part) for name, part in argument.items() if name in value)
            case "additionalProperties":
                others = [item for name, item in value.items() if name not in schema.get("properties", {})]
                fine = all(conforms(item, argument) for item in others) if argument else not others
            case "pattern":
                fine = re.search(argument, value) is not None
            case "propertyNames":
                fine = all(re.search(argument["pattern"], name) for name in value)
            case "items":
                fine = all(conforms(item, argument) for item in value)
            case "minItems":
                fine = len(value) >= argument
            case "maxItems":
                fine = len(value) <= argument
            case "minimum":
                fine = value >= argument
            case _:
                raise AssertionError(f"the schema uses {word}, which this test does not know")
        if not fine:
            return False
    return True


def written(scene: Scene) -> Any:
    line = scene_line(scene)
    assert "\n" not in line
    document = json.loads(line, parse_constant=lambda word: pytest.fail(f"{word} is not JSON"))
    assert conforms(document, SCHEMA)
    return document


class Odd:
    pass


class Broken:
    def __repr__(self) -> str:
        raise RuntimeError


def test_fields_of_a_scene_and_its_objects() -> None:
    chair = Chair(position=(1, 2.5, -3), orientation=Turn.by(0.5, 0.25, 0.125), width=2, color=(1, 0, 0))
    ball = Object(shape=BALL, others={"speed": 3.5})
    scene = Scene([chair, ball], 9, 4, 17, {"time": 12}, egoObject=chair, names={ball: "ball"})
    document = written(scene)
    assert {key: value for key, value in document.items() if key != "objects"} == {
        "format": "scenic-scene",
        "version": 1,
        "seed": 9,
        "k": 4,
        "attempts": 17,
        "params": {"time": 12},
        "ego": 0,
    }
    first, second = document["objects"]
    assert (first["class"], first["name"], second["class"], second["name"]) == (
        "Chair",
        None,
        "Object",
        "ball",
    )
    assert first["position"] == [1, 2.5, -3]
    turn = chair.orientation
    assert first["quaternion"] == [turn.x, turn.y, turn.z, turn.w]
    assert first["euler"] == pytest.approx([0.5, 0.25, 0.125])
    assert first["size"] == [2, 1, 1]
    assert first["shape"] == {"kind": "box"}
    assert first["properties"] == {"color": [1, 0, 0]}
    assert second["properties"] == {"color": None, "speed": 3.5}


def test_quaternions_have_one_sign() -> None:
    document = written(Scene([Object(orientation=Turn(0.0, 0.0, -0.6, -0.8))]))
    assert document["objects"][0]["quaternion"] == [0, 0, 0.6, 0.8]
    assert "-0.0" not in scene_line(Scene([Object(orientation=Turn(0.0, 0.0, -0.6, -0.8))]))


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (None, None),
        (True, True),
        (3, 3),
        (2**80, 2**80),
        ("ünï\ud800", "ünï\ud800"),
        (math.nan, {"$float": "nan"}),
        (math.inf, {"$float": "inf"}),
        (-math.inf, {"$float": "-inf"}),
        (-0.0, 0.0),
        (np.float32(0.5), 0.5),
        (np.int64(5), 5),
        (np.bool_(True), True),
        (np.array([[1.0, math.nan]]), [[1.0, {"$float": "nan"}]]),
        ((1, (2, [3])), [1, [2, [3]]]),
        (Turn(0.0, 0.0, 0.0, 1.0), {"$quaternion": [0, 0, 0, 1]}),
        ({"a": {"b": 1.5}}, {"a": {"b": 1.5}}),
        ({}, {}),
        ({"$float": "nan"}, {"$map": [["$float", "nan"]]}),
        ({1: "x"}, {"$map": [[1, "x"]]}),
        (b"bytes", {"$text": "b'bytes'"}),
        (range(3), {"$text": "range(0, 3)"}),
        (1 + 2j, {"$text": "(1+2j)"}),
        (Odd(), {"$text": f"<{__name__}.Odd object>"}),
        (Broken(), {"$text": "<Broken>"}),
    ],
)
def test_values(value: object, expected: object) -> None:
    document = written(Scene([Object(others={"it": value})], params={"it": value}))
    assert document["params"]["it"] == expected
    assert document["objects"][0]["properties"]["it"] == expected


def test_objects_of_the_scene_are_referred_to() -> None:
    other = Object()
    document = written(Scene([other, Object(others={"friends": [other], "stranger": Odd()})]))
    assert document["objects"][1]["properties"]["friends"] == [{"$object": 0}]


def test_endless_values_end() -> None:
    endless: list[object] = []
    endless += [endless, endless]
    assert plain(endless, {}) == [{"$text": "[[...], [...]]"}] * 2
    deep: object = 0
    for _ in range(100_000):
        deep = [deep]
    assert "$text" in json.dumps(plain(deep, {}))


values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary() | st.complex_numbers(),
    lambda inner: (
        st.lists(inner) | st.dictionaries(st.text() | st.integers(), inner) | st.tuples(inner, inner)
    ),
)


@given(values)
def test_any_value_can_be_written(value: object) -> None:
    document = written(Scene([], params={"it": value}))
    again = written(Scene([], params={"it": value}))
    assert json.dumps(document) == json.dumps(again)


def test_the_example_of_the_page_follows_the_schema() -> None:
    text = (DOCS / "scene-format.md").read_text()
    (example,) = re.findall(r"```json\n(.*?)```", text, re.DOTALL)
    assert conforms(json.loads(example), SCHEMA)


def test_the_page_describes_every_field_of_the_schema() -> None:
    text = (DOCS / "scene-format.md").read_text()
    described = set(re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE))
    parts = [SCHEMA, SCHEMA["$defs"]["object"], SCHEMA["$defs"]["shape"]]
    assert described == {name for part in parts for name in part["properties"]}
    for part in SCHEMA["$defs"]["value"]["anyOf"]:
        for name in part.get("properties", {}):
            assert f'{{"{name}"' in text


@pytest.mark.parametrize(
    "change",
    [
        {"version": 2},
        {"k": -1},
        {"ego": 1},
        {"extra": 1},
        {"params": {"x": {"$text": 5}}},
        {"objects": [{"class": "Object"}]},
    ],
)
def test_the_schema_refuses_other_documents(change: dict[str, Any]) -> None:
    document = json.loads(scene_line(Scene([Object(shape=CYLINDER)])))
    assert conforms(document, SCHEMA)
    assert not conforms(document | change, SCHEMA)


@pytest.mark.parametrize(
    ("value", "told"),
    [(math.inf, {"$float": "inf"}), (-math.inf, {"$float": "-inf"}), (np.float64(2.5), 2.5), (-0.0, 0.0)],
)
def test_places_tell_every_number(value: float, told: object) -> None:
    (thing,) = json.loads(scene_line(Scene([Object((1.0, value, 3.0))])))["objects"]
    assert thing["position"] == [1.0, told, 3.0]
