"""Reading of arguments, and the form of errors."""

from __future__ import annotations

import pytest

from elitescript.dap.messages import WRONG_ARGUMENTS, Arguments, RequestError, error_response


def test_arguments_are_read_with_their_kinds():
    arguments = Arguments(
        {"name": "a", "line": 3, "t": 1, "on": True, "list": ["x"], "items": [{"line": 1}], "inner": {"path": "p"}},
        "launch",
    )
    assert arguments.text("name") == "a"
    assert arguments.number("line") == 3
    assert arguments.real("t") == 1.0
    assert arguments.flag("on") is True
    assert arguments.texts("list") == ["x"]
    assert [item.number("line") for item in arguments.items("items")] == [1]
    assert arguments.inner("inner").text("path") == "p"


def test_what_is_not_given_or_null_is_the_default():
    arguments = Arguments({"line": None}, "launch")
    assert arguments.number("line", 7) == 7
    assert arguments.text("name", "x") == "x"
    assert arguments.flag("on") is False
    assert arguments.items("items") == arguments.texts("list") == []
    assert not arguments.has("line")
    assert Arguments(None, "launch").data == {}


@pytest.mark.parametrize(
    ("read", "text"),
    [
        (lambda a: a.text("none"), "goto: none is missing; it must be a text"),
        (lambda a: a.text("number"), "goto: number must be a text, got 3"),
        (lambda a: a.number("text"), "goto: text must be a whole number, got 'x'"),
        (lambda a: a.number("flag"), "goto: flag must be a whole number, got True"),
        (lambda a: a.number("number", least=4), "goto: number must be 4 or more, got 3"),
        (lambda a: a.number("huge"), "goto: huge must be 0 or more"),
        (lambda a: a.real("text"), "goto: text must be a number, got 'x'"),
        (lambda a: a.real("endless"), "goto: endless must be a finite number, got inf"),
        (lambda a: a.real("huge"), "goto: huge must be a finite number"),
        (lambda a: a.real("flag"), "goto: flag must be a number, got True"),
        (lambda a: a.flag("number"), "goto: number must be true or false, got 3"),
        (lambda a: a.texts("list"), "goto: list must be a list of texts, got 1"),
        (lambda a: a.items("list"), "goto: list[0]: not an object"),
        (lambda a: a.inner("text"), "goto: text: not an object"),
        (lambda a: Arguments([1], "goto"), "goto: not an object"),
    ],
)
def test_wrong_arguments_are_named_with_place_value_and_what_they_must_be(read, text):
    data = {"number": 3, "text": "x", "flag": True, "list": [1], "endless": float("inf"), "huge": 10**400}
    with pytest.raises(RequestError) as raised:
        read(Arguments(data, "goto"))
    assert str(raised.value).startswith(text)
    assert raised.value.number == WRONG_ARGUMENTS


def test_an_error_has_number_and_text_and_no_braces_that_clients_would_replace():
    answer = error_response(4, "evaluate", RequestError(WRONG_ARGUMENTS, "no {name}", is_shown=True))
    assert answer["message"] == "no {name}"
    assert answer["body"] == {"error": {"id": WRONG_ARGUMENTS, "format": "no (name)", "showUser": True}}
