"""A task: its nodes and their rows, read from a file and written to one.

A file that was read and is written without a change has the same bytes; after an edit only what was edited differs.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator
from difflib import SequenceMatcher
from typing import Any, Final

from elitescript.language.garbage import without_collection
from elitescript.program_tree.fields import Objects
from elitescript.program_tree.kinds import BRANCHES, BY_ELEMENT, BY_NODE, Kind
from elitescript.program_tree.nodes import (
    If,
    MainTask,
    Node,
    Unknown,
)
from elitescript.program_tree.references import linked, resolve, share_definitions
from elitescript.program_tree.xml_text import (
    Document,
    Element,
    Shared,
    TaskFileError,
    indented,
    made,
    read_document,
    with_elements,
    written,
)
from elitescript.records import field, record, replace
from elitescript.said import said

LEVELS_MAX: Final = 200
"""Nodes in each other."""

ROOT: Final = "EliTask"


@record
class Damage:
    """Something in a file that a pendant would not write, or writes by mistake; it is survived.

    Attributes:
        line: in the file, from 1.
        text: what it is.
    """

    line: int
    text: str


@record
class Task:
    """A graphical program.

    Attributes:
        name: of the task, and of the function in its script.
        installation: name of its configuration file, without ending.
        robot_type: `CS66`, …; empty: the file does not say it.
        directory, installation_directory: folders below the program folder.
        parts: nodes directly in the task: `InitVariables`, `BeforeStart`, `MainTask`, sub-tasks, threads, events.
        damage: what was survived when it was read.
        document: what it was read from.
    """

    name: str = ""
    installation: str = ""
    robot_type: str = ""
    directory: str = ""
    installation_directory: str = ""
    parts: tuple[Node, ...] = ()
    damage: tuple[Damage, ...] = field(default=(), compare=False, repr=False)
    document: Document | None = field(default=None, compare=False, repr=False)
    read_parts: tuple[Node, ...] = field(default=(), compare=False, repr=False)
    """The nodes as they were read; what is the same object needs no writing."""

    @property
    def main(self) -> MainTask:
        """The main task; an empty one, if the file has none."""
        for part in self.parts:
            if isinstance(part, MainTask):
                return part
        return MainTask()

    def lines_of(self, nodes: Iterable[Node]) -> list[int]:
        """Return the lines of the file in which nodes begin; 0 for one that was not read from it."""
        if self.document is None:
            return [0 for _ in nodes]
        ends = self.document.line_ends()
        offsets = [-1 if node.source is None else node.source.offset for node in nodes]
        return [0 if offset < 0 else bisect_left(ends, offset) + 1 for offset in offsets]

    def span_of(self, node: Node) -> tuple[int, int]:
        """Return where a node begins and ends in the text of the file, in characters; -1: it was not read from one."""
        if self.document is None or node.source is None:
            return -1, -1
        return node.source.offset, self.document.end_of(node.source)


def nodes_in(node: Node) -> tuple[Node, ...]:
    """Return the nodes directly in a node, in the order of their rows."""
    return node.children + node.branches if isinstance(node, If) else node.children


# ---------------------------------------------------------------- reading


@without_collection
def read_task(data: bytes, name: str = "the file") -> Task:
    """Read a `.task` file.

    Args:
        data: its bytes.
        name: for error texts.

    Raises:
        TaskFileError: it is no XML or no task, is too long or too deep; the text has line and column.
    """
    document = read_document(data, name)
    root = document.root
    if root.name != ROOT:
        why = said("this is no task: its outermost element is `{element}`, not `EliTask`", element=root.name[:60])
        raise TaskFileError(name, why, document.line_of(root))
    damage: list[Damage] = []
    objects = Objects()
    if "reference=" in document.text:
        for element in resolve(root):
            line = document.line_of(element)
            damage.append(Damage(line, said("`{element}` refers to something that is not there", element=element.name)))
    reading = _Reading(document, objects, damage, name)
    parts: list[Node] = []
    for element in root.elements:
        if element.name in BY_ELEMENT or element.name.endswith("Node"):
            parts.append(reading.node(element, 1))
    reading.damages()
    given = root.attributes
    damage.sort(key=lambda row: row.line)
    return Task(
        given.get("name", ""),
        given.get("installationName", ""),
        given.get("robotType", ""),
        given.get("directory", ""),
        given.get("installationDirectory", ""),
        tuple(parts),
        tuple(damage),
        document,
        tuple(parts),
    )


class _Reading:
    """Reads nodes of one document."""

    __slots__ = ("damage", "document", "name", "objects", "texts")

    def __init__(self, document: Document, objects: Objects, damage: list[Damage], name: str) -> None:
        self.document = document
        self.objects = objects
        self.damage = damage
        self.name = name
        self.texts: list[tuple[Element, str]] = []

    def node(self, element: Element, level: int) -> Node:
        if level > LEVELS_MAX:
            why = said("more than {limit} nodes stand in each other", limit=LEVELS_MAX)
            raise TaskFileError(self.name, why, self.document.line_of(element))
        if element.name == "CompressNode":
            return self.suppressed(element, level)
        kind = _kind_of(element)
        if kind is None:
            return Unknown(type_name=element.attributes.get("typeName", ""), source=element, element=element.name)
        held = self.objects.held(element)
        values: dict[str, Any] = {}
        for place in kind.fields:
            names = place.names
            read = place.read(held, self.objects)
            if len(names) == 1:
                values[names[0]] = read[0]
            else:
                values.update(zip(names, read, strict=True))
        if kind.holds is not None:
            box = held if not kind.holds else held.child(kind.holds)
            if box is not None:
                self.look_for_text(box, element)
                values["children"] = tuple(
                    self.node(child, level + 1) for child in box.elements if _is_node(child, kind)
                )
        if kind.node is If:
            values["branches"] = tuple(self.node(child, level + 1) for child in held.elements if child.name in BRANCHES)
        return kind.node(type_name=held.attributes.get("typeName", ""), source=element, **values)

    def suppressed(self, element: Element, level: int) -> Node:
        inside = element.child("CompressedNode")
        wrapped = inside.elements if inside is not None else []
        if len(wrapped) != 1:
            line = self.document.line_of(element)
            self.damage.append(Damage(line, said("a suppressed node holds {count} nodes", count=len(wrapped))))
        if not wrapped:
            return Unknown(is_suppressed=True, source=element, element="CompressNode")
        return replace(self.node(wrapped[0], level + 1), is_suppressed=True, source=element)

    def look_for_text(self, box: Element, element: Element) -> None:
        for piece in box.content:
            if isinstance(piece, str) and not piece.isspace() and piece.strip() and not piece.lstrip().startswith("<!"):
                self.texts.append((element, piece.strip()))
                return

    def damages(self) -> None:
        """Note texts between elements, which are ignored, as one row: pendants write some in each file."""
        if self.texts:
            element, text = self.texts[0]
            count = len(self.texts)
            sentence = said("text stands between elements and is ignored: {text!r}", text=text[:60])
            if count > 1:
                sentence = said("{sentence}, and {count} more", sentence=sentence, count=count - 1)
            self.damage.append(Damage(self.document.line_of(element), sentence))


def _kind_of(element: Element) -> Kind | None:
    for kind in BY_ELEMENT.get(element.name, ()):
        attribute, value = kind.when
        if not attribute or element.attributes.get(attribute) == value:
            return kind
    return None


def _is_node(element: Element, kind: Kind) -> bool:
    if not kind.only:
        return True
    return element.name in kind.only or element.name.endswith("Node")


# ---------------------------------------------------------------- writing


def task_bytes(task: Task) -> bytes:
    """Return a task as the bytes of a file."""
    if task.document is None:
        return _new_document(task)
    given = task.document.root.attributes
    root = task.document.root
    for attribute, value in _ROOT_ATTRIBUTES(task):
        if given.get(attribute, "") != value:
            root = root.with_attribute(attribute, value)
    if task.parts == task.read_parts and all(new is old for new, old in zip(task.parts, task.read_parts, strict=True)):
        return written(Document(task.document.front, root, task.document.behind))
    writing = _Writing(Objects(share_definitions(task.document.root)))
    root = writing.box(root, task.parts, "", lambda child: child.name in BY_ELEMENT or child.name.endswith("Node"))
    root = linked(root, writing.changed)
    return written(Document(task.document.front, root, task.document.behind))


def _ROOT_ATTRIBUTES(task: Task) -> Iterator[tuple[str, str]]:
    yield "name", task.name
    yield "installationName", task.installation
    yield "robotType", task.robot_type
    yield "directory", task.directory
    yield "installationDirectory", task.installation_directory


def _new_document(task: Task) -> bytes:
    root = made(ROOT, {name: value for name, value in _ROOT_ATTRIBUTES(task) if value})
    writing = _Writing(Objects())
    root = linked(with_elements(root, [writing.node(part, "  ") for part in task.parts], ""), writing.changed)
    return written(Document("", root, ""))


class _Writing:
    """Writes nodes as elements."""

    __slots__ = ("changed", "objects")

    def __init__(self, objects: Objects) -> None:
        self.objects = objects
        self.changed: dict[Shared, Element] = {}

    def node(self, node: Node, indent: str) -> Element:
        """Return the element of a node; the one that it was read from, if nothing in it is changed."""
        source = node.source
        if source is not None and source.name == "CompressNode":
            inside = source.child("CompressedNode")
            wrapped = inside.elements[0] if inside is not None and inside.elements else None
            if inside is None or wrapped is None:
                return source
            if not node.is_suppressed:
                return indented(self.plain(node, wrapped, indent), indent)
            new = self.plain(node, wrapped, f"{indent}    ")
            return source.with_replaced(source.elements.index(inside), inside.with_replaced(0, new))
        if not node.is_suppressed:
            return self.plain(node, source, indent)
        new = self.plain(node, source, f"{indent}    ")
        return with_elements(
            made("CompressNode", {"commentString": ""}),
            [with_elements(made("CompressedNode"), [new], f"{indent}  ")],
            indent,
        )

    def plain(self, node: Node, source: Element | None, indent: str) -> Element:
        if isinstance(node, Unknown):
            return source if source is not None else made(node.element)
        kind = BY_NODE[type(node)]
        if source is None:
            element = made(kind.element, dict((kind.when,) if kind.when[0] else ()))
            for attribute, value in kind.others:
                element = element.with_attribute(attribute, value)
            if node.type_name:
                element = element.with_attribute("typeName", node.type_name)
            held = element
        else:
            element, held = source, self.objects.held(source)
        new = held
        for place in kind.fields:
            values = tuple(getattr(node, name) for name in place.names)
            if source is None or not _same(place.read(held, self.objects), values):
                new = place.write(new, values, self.objects, indent)
        if kind.holds is not None:
            is_node = lambda child: _is_node(child, kind)  # noqa: E731
            if not kind.holds:
                new = self.box(new, node.children, indent, is_node)
            else:
                box = new.child(kind.holds)
                if box is not None:
                    filled = self.box(box, node.children, f"{indent}  ", is_node)
                    if filled is not box:
                        new = new.with_replaced(new.elements.index(box), filled)
                elif node.children:
                    filled = self.box(made(kind.holds), node.children, f"{indent}  ", is_node)
                    new = new.with_child(len(new.elements), filled, f"{indent}  ")
        if isinstance(node, If):
            new = self.box(new, node.branches, indent, lambda child: child.name in BRANCHES)
        if new is held or source is None:
            return new
        if element.shared is not None:
            self.changed[element.shared] = new
        # An element that refers to an object stays as it is: the object stands elsewhere.
        return new if held is element else element

    def box(self, box: Element, nodes: tuple[Node, ...], indent: str, is_node: Any) -> Element:
        """Return an element whose nodes are these, everything else in it left where it is."""
        inner = f"{indent}  "
        old = [child for child in box.elements if is_node(child)]
        places: dict[int, int] = {id(child): place for place, child in enumerate(old)}
        origins = [places.get(id(node.source), -1 - number) for number, node in enumerate(nodes)]
        if origins != list(range(len(old))):
            return self.rearranged(box, nodes, old, origins, inner)
        for node, element in zip(nodes, old, strict=True):
            new = self.node(node, inner)
            if new is not element:
                box = box.with_replaced(_index(box, element), new)
        return box

    def rearranged(
        self, box: Element, nodes: tuple[Node, ...], old: list[Element], origins: list[int], inner: str
    ) -> Element:
        """Return an element whose nodes are others or in another order; those that can stay where they are do."""
        kept: dict[int, int] = {}
        for start, at, length in SequenceMatcher(None, range(len(old)), origins, False).get_matching_blocks():
            kept.update((at + step, start + step) for step in range(length))
        staying: dict[int, Element] = {}
        inserted: dict[int, list[Element]] = {}
        anchor = -1
        for number, node in enumerate(nodes):
            if number in kept:
                anchor = kept[number]
                staying[id(old[anchor])] = self.node(node, inner)
            else:
                inserted.setdefault(anchor, []).append(indented(self.node(node, inner), inner))
        if not old:
            for element in inserted[-1]:
                box = box.with_child(len(box.elements), element, inner)
            return box
        margin = _margin(box, old[0], inner)
        places = {id(element): place for place, element in enumerate(old)}
        content: list[str | Element] = []
        for piece in box.content:
            place = places.get(id(piece), -1)
            if place == 0 and -1 in inserted:
                for element in inserted[-1]:
                    content += [element, margin]
            if place < 0:
                content.append(piece)
            elif id(piece) in staying:
                content.append(staying[id(piece)])
                for element in inserted.get(place, ()):
                    content += [margin, element]
            elif content and isinstance(content[-1], str):
                content[-1] = content[-1].rstrip()
        if not any(isinstance(piece, Element) or piece.strip() for piece in content):
            content = []
        return box.with_content(tuple(piece for piece in content if piece != ""))


def _margin(box: Element, first: Element, inner: str) -> str:
    """Return what stands in front of the nodes of an element: a line feed and blanks."""
    before = box.content[box.content.index(first) - 1] if box.content[0] is not first else ""
    if isinstance(before, str) and not before.strip() and "\n" in before:
        return before[before.rindex("\n") :]
    return f"\n{inner}"


def _index(box: Element, element: Element) -> int:
    for index, child in enumerate(box.elements):
        if child is element:
            return index
    raise ValueError(element.name)


def _same(read: tuple[Any, ...], given: tuple[Any, ...]) -> bool:
    """Return whether values are the same; NaN is the same as NaN."""
    return read == given or repr(read) == repr(given)
