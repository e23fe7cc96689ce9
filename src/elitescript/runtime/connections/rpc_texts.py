"""Reads texts of XML-RPC from untrusted peers."""

from __future__ import annotations

from typing import Any
from xml.parsers.expat import ParserCreate
from xmlrpc.client import Unmarshaller


def values_and_method(text: bytes) -> tuple[tuple[Any, ...], str | None]:
    """Return the values of a request or response, and the method of a request.

    Declarations of entities are refused; with them a short text can expand to hundreds of megabytes.

    Raises:
        xmlrpc.client.Fault: the text is that of a fault.
        xml.parsers.expat.ExpatError: it is no XML.
        ValueError: it declares a document type. A text that is no XML-RPC can raise other exceptions.
    """
    reader = Unmarshaller(use_builtin_types=True)
    reader.xml("", None)  # texts are decoded already
    parser = ParserCreate()
    parser.StartDoctypeDeclHandler = _refuse_declarations
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.data
    parser.Parse(text, True)
    return reader.close(), reader.getmethodname()


def _refuse_declarations(*_: object) -> None:
    raise ValueError("it declares a type of document")
