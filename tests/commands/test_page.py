from __future__ import annotations

import pytest

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.page import CHAPTERS, chapters, describe, index, kind_of, source_of
from elitescript.commands.definition.quantities import JOINTS, Choice, Number, Vector
from elitescript.commands.definition.registry import Command


def command_called(name: str) -> Command:
    command = CATALOGUE.get(name)
    assert command is not None
    return command


def test_a_page_tells_signature_arguments_units_result_and_source() -> None:
    page = describe(command_called("get_inverse_kin"))
    assert page.startswith("get_inverse_kin(p, qnear='', tcp='active tcp')\n\nReturn joint positions that bring")
    for part in (
        "qnear (list[float] of 6 [rad], default '')",
        "Also written qNear.",
        "Returns:\n    list[float] of 6 [rad]\n",
        "Raises:\n    MotionError\n",
        "Since 2.10, documented, manual 2.10 section 2.2.1.",
    ):
        assert part in page


def test_a_page_tells_what_to_expect() -> None:
    unsimulated = command_called("movej").renamed("unsimulated")
    unsimulated.is_simulated = False
    assert "Not simulated yet" in describe(unsimulated)
    assert "Not in secondary programs." in describe(command_called("movej"))
    assert "Another name of serial_config." in describe(command_called("masterboard_serial_config"))
    assert "Also called masterboard_serial_config." in describe(command_called("serial_config"))
    assert "Not simulated" not in describe(command_called("movej"))


@pytest.mark.parametrize("name", sorted(CATALOGUE.names()))
def test_every_page_fits_the_terminal(name: str) -> None:
    lines = describe(command_called(name)).split("\n")
    assert all(len(line) <= 100 for line in lines[1:])
    assert lines[-1].endswith(".")


def test_the_index_has_every_command_once() -> None:
    rows = [line.strip() for line in index(CATALOGUE).split("\n") if line.startswith("  ")]
    names = [row.removeprefix("(-)").strip().partition("(")[0] for row in rows]
    assert sorted(names) == sorted(command.name for command in CATALOGUE)
    assert not any(row.startswith("(-)") for row in rows)
    assert any(row.startswith("movej(") for row in rows)
    assert any(row == "pause()  since 2.14" for row in rows)


def test_every_chapter_has_commands_in_the_order_of_their_names() -> None:
    found = chapters(CATALOGUE)
    assert list(found) == list(CHAPTERS)
    for commands in found.values():
        assert commands
        assert [command.name for command in commands] == sorted(command.name for command in commands)


def test_kinds_are_written_with_range_and_unit() -> None:
    assert kind_of(JOINTS) == "list[float] of 6 [rad]"
    assert kind_of(Number("s", 0.0)) == "float, >= 0 [s]"
    assert kind_of(Vector(Choice(0, 1), 4)) == "list[int] of 4, each one of 0, 1"


def test_sources_name_the_manual() -> None:
    assert source_of(command_called("movej")) == "since 2.10, documented, manual 2.10 section 2.1.1"
    assert source_of(command_called("pause")) == "since 2.14, documented, manual 2.14 section 9.2.1"
    assert source_of(command_called("set_tool_digital_io_config")) == "since 2.10, documented, manual 2.14 section 5.19"
    assert source_of(command_called("sync")) == "since 2.10, observed"
    assert source_of(command_called("bit_list_to_integer")) == "since 2.13, documented"
