from __future__ import annotations

from typing import Any

import pytest


@pytest.mark.parametrize(
    ("values", "text"),
    [
        (("value=", 3), "value=3"),
        (([1, 2.5, True],), "[1, 2.5, True]"),
        (("a", "b"), "ab"),
        ((None,), "None"),
        ((0.1, 1e-9), "0.11e-09"),
        (("a", "b", 3, [4]), "ab3[4]"),
        (("a" * 5000,), "a" * 5000),
    ],
)
def test_textmsg_joins_what_str_writes(call: Any, robot: Any, values: tuple[Any, ...], text: str) -> None:
    call("textmsg", *values)
    assert robot.asked == [("message", text)]


@pytest.mark.parametrize(
    ("flags", "level"),
    [({}, "info"), ({"warning": True}, "warning"), ({"error": True}, "error"), ({"warning": 1, "error": 1}, "error")],
)
def test_popup_levels(call: Any, robot: Any, flags: dict[str, Any], level: str) -> None:
    call("popup", [1, 2], **flags)
    assert robot.asked == [("popup", "[1, 2]", "Popup", level, False)]


@pytest.mark.parametrize(("is_secondary", "blocks"), [(False, True), (True, False)])
def test_popup_never_blocks_a_secondary_program(call: Any, robot: Any, is_secondary: bool, blocks: bool) -> None:
    robot.is_secondary = is_secondary
    call("popup", "Stop", title=5, blocking=True)
    assert robot.asked == [("popup", "Stop", "5", "info", blocks)]
