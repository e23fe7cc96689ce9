"""XML as a tree of pieces of its text: what is not changed is written as it was read, to the byte.

A reader of XML that gives values alone cannot do that: blanks in tags, the order of attributes, quotation marks, `<X/>`
or `<X></X>` and comments would be lost. So expat, which is strict, decides whether a text is XML at all, and one
expression cuts it into tags and what is between them; an element keeps these pieces. Why expat: decision record 0038.

Texts come from strangers. A DTD is refused before anything in it is read, so there are no entities but the five of XML
and numbers of characters, and nothing is ever fetched.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Final
from xml.parsers import expat

from elitescript.errors import UsageError
from elitescript.said import said
from elitescript.untrusted.plain_text import EncodingError, plain_text

BYTES_MAX: Final = 64 * 1024 * 1024
"""Bytes of a file."""
DEPTH_MAX: Final = 450
"""Elements in each other. A node takes one or two; 200 nodes in each other are the most that a tree may have."""

_TAG: Final = re.compile(
    r"(<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<[^<>\"']*(?:\"[^\"]*\"[^<>\"']*|'[^']*'[^<>\"']*)*>)", re.DOTALL
)
_ATTRIBUTE: Final = re.compile(r"""\s([^\s=<>"'/]+)\s*=\s*("[^"]*"|'[^']*')""")
_REFERENCE: Final = re.compile(r"&(?:#x([0-9a-fA-F]+)|#([0-9]+)|(lt|gt|amp|quot|apos));")
_ENTITIES: Final = {"lt": "<", "gt": ">", "amp": "&", "quot": '"', "apos": "'"}
_INSIDE: Final = re.compile(r"<!--.*?-->|<\?.*?\?>|<!\[CDATA\[(.*?)\]\]>|([^<]+)", re.DOTALL)
_BOM: Final = "\ufeff"


class TaskFileError(UsageError):
    """A file that is no task, or none of those beside it.

    Args:
        name: of the file.
        why: what is wrong.
        line, column: where, from 1; no column: the line as a whole; no line: the file.
    """

    def __init__(self, name: str, why: str, line: int = 0, column: int = 0) -> None:
        place = ":".join([name, *(str(number) for number in (line, column) if number)])
        super().__init__(said("{place}: {why}", place=place, why=why))
        self.name = name
        self.why = why
        self.line = line or 1
        self.column = column or 1


class Shared:
    """An object that may stand in more than one place of a file, with the element that held it when it was read."""

    __slots__ = ("holder",)

    def __init__(self, holder: Element | None = None) -> None:
        self.holder = holder


class Element:
    """An element: the text of its tags, and what is between them. It is never changed; edits make others.

    Attributes:
        name: of its tags.
        head: the first tag as it is written, `<X a="1">` or `<X/>`.
        content: texts and elements, in their order.
        tail: the last tag, empty after `<X/>`.
        offset: where it begins in the text that was read, in characters; -1: it was made here.
        shared: the object that it holds or refers to, the same for all its elements; None: it is alone. Set once, when
            the references of a document are resolved.
    """

    __slots__ = ("_attributes", "_elements", "content", "head", "name", "offset", "shared", "tail")

    def __init__(
        self,
        name: str,
        head: str,
        content: tuple[str | Element, ...] = (),
        tail: str = "",
        offset: int = -1,
        shared: Shared | None = None,
    ) -> None:
        self.name = name
        self.head = head
        self.content = content
        self.tail = tail
        self.offset = offset
        self.shared = shared
        self._attributes: dict[str, str] | None = None
        self._elements: list[Element] | None = None

    @property
    def attributes(self) -> dict[str, str]:
        """The attributes by name, in their order, with their values as they are meant; not to be changed."""
        if self._attributes is None:
            given = _ATTRIBUTE.findall(self.head)
            if "&" in self.head:
                self._attributes = {name: _plain(raw[1:-1]) for name, raw in given}
            else:
                self._attributes = {name: raw[1:-1] for name, raw in given}
        return self._attributes

    @property
    def elements(self) -> list[Element]:
        """The elements in it; not to be changed."""
        if self._elements is None:
            self._elements = [piece for piece in self.content if piece.__class__ is Element]
        return self._elements

    @property
    def text(self) -> str:
        """The text directly in it, without that of elements in it; ends of lines are line feeds."""
        pieces = [
            cdata or _plain(plain)
            for piece in self.content
            if isinstance(piece, str)
            for cdata, plain in _INSIDE.findall(piece)
        ]
        return "".join(pieces).replace("\r\n", "\n").replace("\r", "\n")

    def child(self, name: str) -> Element | None:
        """Return the first element of a name in it."""
        for element in self.elements:
            if element.name == name:
                return element
        return None

    def everything(self) -> Iterator[Element]:
        """Yield this element and all in it, in document order."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.elements))

    # ------------------------------------------------------------ edits

    def with_attribute(self, name: str, value: str | None) -> Element:
        """Return it with another value of an attribute; a new one stands last, None leaves it out."""
        given = self.attributes
        if given.get(name) == value:
            return self
        if value is None:
            head = re.sub(rf"\s{re.escape(name)}\s*=\s*(\"[^\"]*\"|'[^']*')", "", self.head, count=1)
        elif name in given:
            head = re.sub(
                rf"(\s{re.escape(name)}\s*=\s*)(\"[^\"]*\"|'[^']*')",
                lambda found: f'{found[1]}"{escaped(value)}"',
                self.head,
                count=1,
            )
        else:
            end = -2 if self.head.endswith("/>") else -1
            head = f'{self.head[:end].rstrip()} {name}="{escaped(value)}"{self.head[end:]}'
        return Element(self.name, head, self.content, self.tail, self.offset, self.shared)

    def with_content(self, content: tuple[str | Element, ...]) -> Element:
        """Return it with something else between its tags; nothing makes it `<X/>`."""
        if content == self.content:
            return self
        head, tail = self.head, self.tail
        if not content and tail:
            head, tail = f"{head[:-1].rstrip()}/>", ""
        elif content and not tail:
            head, tail = f"{head[:-2].rstrip()}>", f"</{self.name}>"
        return Element(self.name, head, content, tail, self.offset, self.shared)

    def with_text(self, text: str) -> Element:
        """Return it with a text and no element between its tags."""
        return self if not self.elements and self.text == text else self.with_content((escaped(text),) if text else ())

    def with_child(self, index: int, child: Element, indent: str) -> Element:
        """Return it with another element in front of its element number `index`, on a line of its own."""
        content = list(self.content)
        places = [place for place, piece in enumerate(content) if piece.__class__ is Element]
        margin = f"\n{indent}"
        if not places:
            inside = "".join(piece for piece in content if isinstance(piece, str))
            kept = () if not inside.strip() else (inside,)
            return self.with_content((*kept, margin, child, f"\n{indent[:-2]}"))
        if index >= len(places):
            content[places[-1] + 1 : places[-1] + 1] = [margin, child]
        else:
            content[places[index] : places[index]] = [child, margin]
        return self.with_content(tuple(content))

    def without_child(self, index: int) -> Element:
        """Return it without its element number `index` and the blanks in front of it."""
        content = list(self.content)
        places = [place for place, piece in enumerate(content) if piece.__class__ is Element]
        place = places[index]
        del content[place]
        before = content[place - 1] if place else None
        if isinstance(before, str):
            content[place - 1] = before.rstrip()
        if not any(isinstance(piece, Element) or piece.strip() for piece in content):
            content = []
        return self.with_content(tuple(piece for piece in content if piece != ""))

    def with_replaced(self, index: int, child: Element) -> Element:
        """Return it with another element in place of its element number `index`."""
        content = list(self.content)
        place = [place for place, piece in enumerate(content) if piece.__class__ is Element][index]
        if content[place] is child:
            return self
        content[place] = child
        return self.with_content(tuple(content))


def made(name: str, attributes: dict[str, str] | None = None, text: str = "") -> Element:
    """Return a new element with attributes and a text."""
    head = "".join(f' {key}="{escaped(value)}"' for key, value in (attributes or {}).items())
    if text:
        return Element(name, f"<{name}{head}>", (escaped(text),), f"</{name}>")
    return Element(name, f"<{name}{head}/>")


def with_elements(element: Element, elements: list[Element], indent: str) -> Element:
    """Return an element with elements in it, each on a line of its own; `indent` is that of the element itself."""
    if not elements:
        return element.with_content(())
    content: list[str | Element] = []
    for child in elements:
        content += [f"\n{indent}  ", indented(child, f"{indent}  ")]
    return element.with_content((*content, f"\n{indent}"))


def indented(element: Element, indent: str) -> Element:
    """Return an element as it stands on a line that begins with these blanks; texts with no element are left alone."""
    places = element.elements
    if not places:
        return element
    content: list[str | Element] = []
    for piece in element.content:
        if isinstance(piece, Element):
            content.append(indented(piece, f"{indent}  "))
        elif piece.strip():
            content.append(piece)
        else:
            content.append("\n" * max(1, piece.count("\n")) + f"{indent}  ")
    if isinstance(content[-1], str) and not content[-1].strip():
        content[-1] = f"\n{indent}"
    return element.with_content(tuple(content))


class Document:
    """A file of XML: what is in front of the outermost element and behind it, and that element."""

    __slots__ = ("behind", "front", "root", "text")

    def __init__(self, front: str, root: Element, behind: str, text: str = "") -> None:
        self.front = front
        self.root = root
        self.behind = behind
        self.text = text
        """The text that was read, in which `offset` of elements counts."""

    def line_ends(self) -> list[int]:
        """Return the places of line feeds in the text."""
        return [found.start() for found in re.finditer("\n", self.text)]

    def line_of(self, element: Element) -> int:
        """Return the line in which an element begins, from 1; 0: it was not read from a file."""
        return self.text.count("\n", 0, element.offset) + 1 if element.offset >= 0 else 0

    def end_of(self, element: Element) -> int:
        """Return where an element ends in the text that was read, in characters; -1: it was not read from a file."""
        if element.offset < 0:
            return -1
        waiting: list[str | Element] = [element]
        length = 0
        while waiting:
            piece = waiting.pop()
            if isinstance(piece, str):
                length += len(piece)
            else:
                length += len(piece.head) + len(piece.tail)
                waiting.extend(piece.content)
        return element.offset + length


def read_document(data: bytes, name: str = "the file") -> Document:
    """Return XML as a document.

    Raises:
        TaskFileError: it is too long or too deep, is not UTF-8, is no XML, or has a DTD; with line and column.
    """
    if len(data) > BYTES_MAX:
        raise TaskFileError(name, said("the file has more than {limit} bytes", limit=BYTES_MAX))
    try:
        text = data.decode("utf-8")
        if "\0" in text:
            plain_text(data)
    except UnicodeDecodeError:
        raise _not_utf8(data, name) from None
    except EncodingError as error:
        raise _located(error, data, name) from None
    _refuse_what_is_no_xml(data, name)
    return _cut(text, name)


def _not_utf8(data: bytes, name: str) -> TaskFileError:
    """Return why bytes are no text: the encoding that they are in, or the line of the first that is not UTF-8."""
    try:
        plain_text(data)
    except EncodingError as error:
        return _located(error, data, name)
    return TaskFileError(name, said("this is not UTF-8"))


def _located(error: EncodingError, data: bytes, name: str) -> TaskFileError:
    line = data.count(b"\n", 0, error.at) + 1
    encoding = error.encoding
    why = said("the text is {encoding}, not UTF-8", encoding=encoding) if encoding else said("this is not UTF-8")
    return TaskFileError(name, why, line)


def written(document: Document) -> bytes:
    """Return a document as the bytes of a file."""
    pieces: list[str] = [document.front]
    waiting: list[str | Element] = [document.root]
    while waiting:
        piece = waiting.pop()
        if isinstance(piece, str):
            pieces.append(piece)
            continue
        pieces.append(piece.head)
        waiting.append(piece.tail)
        waiting.extend(reversed(piece.content))
    pieces.append(document.behind)
    return "".join(pieces).encode("utf-8")


def escaped(text: str) -> str:
    """Return a text as it stands in XML, also between quotation marks."""
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")
    return _CONTROL.sub("", text)


_CONTROL: Final = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff\ud800-\udfff]")
"""Characters that no XML can hold."""


def _refuse_what_is_no_xml(data: bytes, name: str) -> None:
    parser = expat.ParserCreate()

    def located(text: str) -> TaskFileError:
        return TaskFileError(name, text, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)

    def refuse(text: str) -> Callable[..., None]:
        def refused(*_: object) -> None:
            raise located(text)

        return refused

    def declared(_: str, encoding: str | None, __: int) -> None:
        if encoding is not None and encoding.lower() not in ("utf-8", "utf8", "us-ascii"):
            raise located(said("the encoding {encoding!r} is not UTF-8", encoding=encoding))

    parser.XmlDeclHandler = declared
    parser.StartDoctypeDeclHandler = refuse(said("a task file has no DTD: nothing outside a file is read for it"))
    parser.EntityDeclHandler = refuse(said("a task file declares no entities"))
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        why = said("no XML: {text}", text=expat.ErrorString(error.code))
        raise TaskFileError(name, why, error.lineno, error.offset + 1) from None


def _cut(text: str, file_name: str) -> Document:
    """Return a text that is XML as a document."""
    root: Element | None = None
    front: list[str | Element] = []
    behind: list[str | Element] = []
    open_heads: list[tuple[str, str, int]] = []
    contents: list[list[str | Element]] = [front]
    offset = 0
    for index, piece in enumerate(_TAG.split(text)):
        here, offset = offset, offset + len(piece)
        if not index & 1:
            if piece:
                contents[-1].append(piece)
            continue
        second = piece[1]
        if second in "!?":
            contents[-1].append(piece)
        elif second == "/":
            name, head, start = open_heads.pop()
            element = Element(name, head, tuple(contents.pop()), piece, start)
            if open_heads:
                contents[-1].append(element)
            else:
                root, contents[-1] = element, behind
        else:
            name = piece.split(None, 1)[0][1:].rstrip("/>")
            if piece[-2] == "/":
                element = Element(name, piece, (), "", here)
                if open_heads:
                    contents[-1].append(element)
                else:
                    root, contents[-1] = element, behind
            else:
                if len(open_heads) >= DEPTH_MAX:
                    raise _too_deep(text, here, file_name)
                open_heads.append((name, piece, here))
                contents.append([])
    assert root is not None  # expat has seen one.
    return Document(_joined(front), root, _joined(behind), text)


def _joined(pieces: list[str | Element]) -> str:
    return "".join(piece for piece in pieces if isinstance(piece, str))


def _too_deep(text: str, offset: int, name: str) -> TaskFileError:
    line = text.count("\n", 0, offset) + 1
    column = offset - text.rfind("\n", 0, offset)
    return TaskFileError(name, said("more than {limit} elements stand in each other", limit=DEPTH_MAX), line, column)


def _plain(raw: str) -> str:
    return _REFERENCE.sub(_character, raw) if "&" in raw else raw


def _character(found: re.Match[str]) -> str:
    hexadecimal, decimal, entity = found.groups()
    if entity:
        return _ENTITIES[entity]
    return chr(int(hexadecimal, 16) if hexadecimal else int(decimal))
