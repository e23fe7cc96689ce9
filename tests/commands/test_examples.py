"""The computed examples of the manuals, and every error condition."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest

from elitescript import errors
from elitescript.commands.catalogue import CATALOGUE
from elitescript.messages.profile import profile
from tests.commands.facts import FACTS


def is_simulated(name: str) -> bool:
    command = CATALOGUE.get(name)
    assert command is not None
    return command.is_simulated


SENT = "modbus_send_custom_command"
"""What its example computes is what it sends: see `test_modbus_tcp`."""
EXAMPLES = [example for example in FACTS["examples"] if is_simulated(example["name"]) and example["name"] != SENT]
NOT_YET = [example for example in FACTS["examples"] if not is_simulated(example["name"])]


@pytest.mark.parametrize("example", EXAMPLES, ids=[example["call"][:60] for example in EXAMPLES])
def test_example_of_the_manual(example: dict[str, Any], script: Callable[[str], Any]) -> None:
    result = script(example["call"])
    exact = example["exact"]
    if isinstance(exact, float) or (isinstance(exact, list) and isinstance(exact[0], float)):
        assert result == pytest.approx(exact, abs=2e-12)
    elif isinstance(exact, list) and isinstance(exact[0], list):
        # Printed with six decimals, on a CS66 without a tool.
        assert [type(row) for row in result] == [list] * len(exact)
        for row, printed in zip(result, exact, strict=True):
            assert row == pytest.approx(printed, abs=6e-7)
    else:
        assert result == exact
        assert isinstance(result, list) == isinstance(exact, list)
        assert isinstance(result, bool) == isinstance(exact, bool)


@pytest.mark.parametrize("example", NOT_YET, ids=[example["call"][:60] for example in NOT_YET])
def test_example_of_a_command_that_is_not_simulated(example: dict[str, Any], script: Callable[[str], Any]) -> None:
    with pytest.raises(errors.NotSimulatedError, match=f"^{example['name']}: .* not simulated"):
        script(example["call"])


@pytest.mark.parametrize("case", FACTS["errors"], ids=[case["call"][:70] for case in FACTS["errors"]])
def test_error_condition(case: dict[str, Any], script: Callable[[str], Any], robot: Any) -> None:
    robot.is_secondary = case.get("sec", False)
    robot.profile = profile(case.get("firmware", "2.14"))
    with pytest.raises(getattr(errors, case["raises"])) as caught:
        script(case["call"])
    name = case["call"].partition("(")[0]
    assert caught.value.code == case["code"]
    assert caught.value.command == name
    assert str(caught.value).startswith(name)
    assert len(re.findall(rf"\b{name}\b", str(caught.value))) == 1
    assert robot.asked == []
