"""Objects that stand in more than one place of a file: the first place holds them, the others refer to it by a path.

A `reference` is a path of the XStream library: `..` is the element around, `Name` its first element of that name,
`Name[k]` its k-th one. Paths follow from places, so they are worked out anew when a document has been edited; the first
place in document order holds the object, whatever was moved or removed.
"""

from __future__ import annotations

import re
from typing import Final

from elitescript.program_tree.xml_text import Element, Shared

_STEP: Final = re.compile(r"([^\[\]/]+)(?:\[([0-9]+)\])?")


def resolve(root: Element) -> list[Element]:
    """Find the objects of a document that is referred to, and set `Element.shared` of all their elements.

    Returns:
        The references that lead nowhere.
    """
    parents: dict[int, Element] = {}
    referring: list[Element] = []
    for element in root.everything():
        for child in element.elements:
            parents[id(child)] = element
        if "reference=" in element.head and "reference" in element.attributes:
            referring.append(element)
    named: dict[int, dict[str, list[Element]]] = {}

    def follow(element: Element) -> Element | None:
        place: Element | None = element
        for step in element.attributes["reference"].split("/"):
            if place is None:
                return None
            if step == "..":
                place = parents.get(id(place))
                continue
            read = _STEP.fullmatch(step)
            if read is None:
                return None
            if id(place) not in named:
                by_name = named[id(place)] = {}
                for child in place.elements:
                    by_name.setdefault(child.name, []).append(child)
            same = named[id(place)].get(read[1], [])
            number = int(read[2] or 1)
            place = same[number - 1] if 0 < number <= len(same) else None
        return place

    found: list[tuple[Element, Element]] = []
    broken: list[Element] = []
    for element in referring:
        target: Element | None = element
        seen: set[int] = set()
        while target is not None and "reference" in target.attributes:
            if id(target) in seen:
                target = None
                break
            seen.add(id(target))
            target = follow(target)
        if target is None:
            broken.append(element)
        else:
            found.append((element, target))
    for element, target in found:
        if target.shared is None:
            target.shared = Shared(target)
        element.shared = target.shared
    return broken


def share_definitions(root: Element) -> dict[tuple[str, str], Shared]:
    """Make objects of the variables and sub-tasks that nothing refers to yet, so that copies of them will.

    Returns:
        All objects by what they are and their names.
    """
    objects: dict[tuple[str, str], Shared] = {}
    for element in root.everything():
        kind = _OBJECTS.get(element.name)
        if kind is not None and "name" in element.attributes:
            if element.shared is None:
                element.shared = Shared(element)
            objects.setdefault((kind, element.attributes["name"]), element.shared)
    return objects


_OBJECTS: Final = {"TaskVariable": "variable", "variable": "variable", "subTask": "sub-task", "SubTaskNode": "sub-task"}


def linked(root: Element, changed: dict[Shared, Element]) -> Element:
    """Return an edited document with each object in the first of its places and paths in the others.

    Args:
        root: of the document.
        changed: objects that are to be written otherwise than they were read.
    """
    return _Linking(changed).element(root, ())


class _Linking:
    """Goes through a document once, in its order."""

    __slots__ = ("changed", "places")

    def __init__(self, changed: dict[Shared, Element]) -> None:
        self.changed = changed
        self.places: dict[Shared, tuple[str, ...]] = {}

    def element(self, element: Element, place: tuple[str, ...]) -> Element:
        shared = element.shared
        if shared is not None:
            if shared in self.places:
                path = _path(place, self.places[shared])
                if element.attributes.get("reference") == path:
                    return element
                if "reference" in element.attributes:
                    return element.with_attribute("reference", path)
                return Element(element.name, f'<{element.name} reference="{path}"/>', shared=shared)
            self.places[shared] = place
            holder = self.changed.get(shared)
            if holder is None and "reference" in element.attributes:
                holder = shared.holder
            if holder is not None and holder is not element:
                element = _named(holder, element.name)
        counts: dict[str, int] = {}
        content: list[str | Element] = []
        is_changed = False
        for piece in element.content:
            if isinstance(piece, Element):
                number = counts[piece.name] = counts.get(piece.name, 0) + 1
                step = piece.name if number == 1 else f"{piece.name}[{number}]"
                child = self.element(piece, (*place, step))
                is_changed |= child is not piece
                piece = child
            content.append(piece)
        return element.with_content(tuple(content)) if is_changed else element


def _named(element: Element, name: str) -> Element:
    """Return an element under another name."""
    if element.name == name:
        return element
    head = f"<{name}{element.head[1 + len(element.name) :]}"
    return Element(name, head, element.content, f"</{name}>" if element.tail else "", shared=element.shared)


def _path(origin: tuple[str, ...], target: tuple[str, ...]) -> str:
    shared = 0
    while shared < min(len(origin), len(target)) and origin[shared] == target[shared]:
        shared += 1
    return "/".join((*[".."] * (len(origin) - shared), *target[shared:]))
