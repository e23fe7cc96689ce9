"""Texts of XML-RPC."""

from __future__ import annotations

from xmlrpc import client

import pytest

from elitescript.runtime.connections.rpc_texts import values_and_method

VALUES = (1, 2.5, True, "prüf <&>", b"\x00\xff", [1, [2]], {"a": {"b": None}})


def test_requests_and_answers() -> None:
    request = client.dumps(VALUES, "part.find", allow_none=True).encode()
    assert values_and_method(request) == (VALUES, "part.find")
    answer = client.dumps((VALUES,), methodresponse=True, allow_none=True, encoding="latin-1").encode("latin-1")
    assert values_and_method(answer) == ((list(VALUES),), None)


def test_a_fault_is_raised() -> None:
    with pytest.raises(client.Fault, match="no part"):
        values_and_method(client.dumps(client.Fault(7, "no part")).encode())


@pytest.mark.parametrize("kind", ['<!DOCTYPE m [<!ENTITY e "x">]>', '<!DOCTYPE m SYSTEM "http://127.0.0.1/e.dtd">'])
def test_a_type_of_document_is_refused(kind: str) -> None:
    with pytest.raises(ValueError, match="declares a type of document"):
        values_and_method((kind + "<methodResponse/>").encode())
