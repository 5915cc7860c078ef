"""Names in the signals and controllers of a map that mean nothing: lanes, signals and controllers that are not there."""

from collections.abc import Iterator

from scenic.formats.opendrive.attributes import validity
from scenic.formats.opendrive.records import MapProblem
from scenic.formats.opendrive.xml_tree import Element

__all__ = ["unknown_references"]


def unknown_references(root: Element) -> Iterator[MapProblem]:
    """Report names that nothing has; signals that other roads refer to are linked, and reported, with the roads."""
    signals = {
        signal.attributes["id"]
        for road in root.all("road")
        for group in road.all("signals")
        for signal in group.all("signal")
        if "id" in signal.attributes
    }
    objects = {
        item.attributes.get("id")
        for road in root.all("road")
        for group in road.all("objects")
        for item in group.children
    }
    controllers = {item.attributes.get("id") for item in root.all("controller")}
    for road in root.all("road"):
        yield from _of_road(road, signals, objects)
    for controller in root.all("controller"):
        name = f"controller {controller.attributes.get('id')}"
        yield from _missing(name, controller, "control", "signalId", "signal", signals)
    for junction in root.all("junction"):
        name = f"junction {junction.attributes.get('id')}"
        yield from _missing(name, junction, "controller", "id", "controller", controllers)


def _of_road(road: Element, signals: set[str], objects: set[str | None]) -> Iterator[MapProblem]:
    lanes = {
        lane.attributes.get("id")
        for part in road.all("lanes")
        for section in part.all("laneSection")
        for side in section.children
        for lane in side.all("lane")
    }
    for group in road.all("signals"):
        for item in group.children:
            name = f"signal {item.attributes.get('id')} of road {road.attributes.get('id')}"
            for low, high in validity(item):
                # Some exporters write lanes 0 to 0 where they mean none.
                if (low, high) != (0, 0) and not any(str(lane) in lanes for lane in range(low, high + 1)):
                    which = f"lane {low}" if low == high else f"lanes {low} to {high}"
                    message = (
                        f"{name} is valid for {which}, which the road does not have: it holds for nobody"
                    )
                    yield MapProblem("SC621", message, item.line, "validity")
            yield from _missing(name, item, "dependency", "id", "signal", signals)
            for reference in item.all("reference"):
                identifiers = (
                    signals if reference.attributes.get("elementType") == "signal" else objects | signals
                )
                target = reference.attributes.get("elementId")
                if target is not None and target not in identifiers:
                    kind = reference.attributes.get("elementType", "element")
                    message = f"{name} refers to {kind} {target}, which is not there"
                    yield MapProblem("SC623", message, reference.line, "signal reference")


def _missing(
    name: str, element: Element, tag: str, attribute: str, kind: str, known: set[str] | set[str | None]
) -> Iterator[MapProblem]:
    """Report children of an element that name something unknown."""
    for item in element.all(tag):
        named = item.attributes.get(attribute)
        if named is not None and named not in known:
            message = f"{name} names {kind} {named}, which is not there"
            yield MapProblem("SC623", message, item.line, f"{kind} of {element.tag}")
