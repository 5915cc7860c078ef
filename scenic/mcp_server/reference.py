"""The reference of the language by topics, from the declarations, and a search over checked examples."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib import resources
from typing import Any, Final

from scenic.language.diagnostics import CODES
from scenic.language.explanations import explanation
from scenic.language.keywords import TEMPORAL_OPERATORS
from scenic.language.names import NAMES, NameKind
from scenic.language.operators import OPERATORS
from scenic.language.properties import CLASSES
from scenic.language.specifiers import SPECIFIERS
from scenic.language.spelling import nearest
from scenic.language.statements import STATEMENTS

__all__ = ["TOPICS", "explain_code", "reference_text", "search_examples", "snippets"]

TOPICS: Final = (
    "statements",
    "specifiers",
    "operators",
    "temporal operators",
    "classes",
    "distributions",
    "regions",
    "shapes",
    "functions",
    "diagnostics",
)
"""The topics of the reference; each name of an element is a topic, too."""

_KINDS: Final[Mapping[str, NameKind]] = {
    "distributions": NameKind.DISTRIBUTION,
    "regions": NameKind.REGION,
    "shapes": NameKind.SHAPE,
    "functions": NameKind.FUNCTION,
}


def reference_text(topic: str) -> str | None:
    """Return the text about a topic or an element of the language; ``None`` if there is none."""
    words = " ".join(topic.lower().replace("_", " ").split()).strip("`")
    if not words:
        return "\n".join(f"- {name}" for name in TOPICS)
    for topic_name in (words, f"{words}s"):
        entries = dict(_topic(topic_name))
        if entries:
            return f"# {topic_name.capitalize()}\n\n" + "\n\n".join(entries.values())
    everything = {name.lower(): text for each in TOPICS for name, text in _topic(each)}
    if words in everything:
        return everything[words]
    matches = [text for name, text in everything.items() if words in name.split()]
    return "\n\n".join(matches) or None


def similar_topic(topic: str) -> str | None:
    """Return the topic or element that is probably meant."""
    return nearest(topic, {*TOPICS, *(name for each in TOPICS for name, _ in _topic(each))})


def _topic(topic: str) -> Iterator[tuple[str, str]]:
    """Yield the elements of a topic, each with its text."""
    if topic == "statements":
        for statement in STATEMENTS.values():
            places = ", ".join(sorted(place.value for place in statement.places))
            text = f"{_forms(statement.forms)}\n{statement.documentation}\nWhere: {places}."
            yield statement.title, f"## {statement.title}\n{text}"
    elif topic == "specifiers":
        for specifier in SPECIFIERS.values():
            properties = ", ".join(
                f"{each.property} (priority {each.priority})" for each in specifier.specifies
            )
            more = f"\nGives {properties}." if properties else ""
            yield (
                specifier.name,
                f"## {specifier.name}\n{_forms(specifier.forms)}\n{specifier.documentation}{more}",
            )
    elif topic == "operators":
        for operator in OPERATORS.values():
            result = f"\nResult: {operator.result}."
            yield (
                operator.name,
                f"## {operator.name}\n{_forms(operator.forms)}\n{operator.documentation}{result}",
            )
    elif topic == "temporal operators":
        for name, temporal in TEMPORAL_OPERATORS.items():
            yield name, f"## {name}\n{_forms(temporal.forms)}\n{temporal.documentation}"
    elif topic == "classes":
        for name, declaration in CLASSES.items():
            rows = [f"- `{item.name}`: {item.type}. {item.documentation}" for item in declaration.properties]
            yield name, f"## {name}\n{declaration.documentation}\n" + "\n".join(rows)
    elif topic == "diagnostics":
        yield from ((code, f"- {code}: {title}") for code, title in CODES.items())
    elif topic in _KINDS:
        for name, declared_name in NAMES.items():
            if declared_name.kind is _KINDS[topic]:
                yield name, f"## {name}\n`{declared_name.signature}`\n{declared_name.documentation}"


def _forms(forms: Sequence[str]) -> str:
    return "\n".join(f"- `{form}`" for form in forms)


def explain_code(code: str) -> str | None:
    """The page of a diagnostic, however its code is written; ``None`` if there is no such code."""
    found = re.search(r"(?:SC)?(\d{3})\b", code.upper())
    known = f"SC{found[1]}" if found is not None else ""
    return explanation(known).text if known in CODES else None


@cache
def snippets() -> tuple[Mapping[str, Any], ...]:
    """Return the checked examples of the documentation."""
    text = resources.files("scenic.language").joinpath("snippets.jsonl").read_text(encoding="utf-8")
    return tuple(json.loads(line) for line in text.splitlines())


_WEIGHTS: Final = (("topic", 5), ("section", 2), ("program", 2), ("text", 1))


def search_examples(query: str, count: int = 5) -> list[dict[str, str]]:
    """Return the examples that match the words of a query best; none if no word occurs."""
    words = {word.lower() for word in re.findall(r"\w+", query) if len(word) > 1}
    scores = []
    for number, snippet in enumerate(snippets()):
        score = 0
        for field, weight in _WEIGHTS:
            present = set(re.findall(r"\w+", snippet[field].lower()))
            score += weight * len(words & present)
        if score:
            scores.append((-score, len(snippet["program"]), number))
    return [
        {name: snippets()[number][name] for name in ("section", "page", "text", "program")}
        for *_, number in sorted(scores)[:count]
    ]
