"""Changes of constants: which there are, and that each is one other value in its place."""

from __future__ import annotations

import ast
from pathlib import Path

from tools.flip_constants import SOURCE, TABLES, applied, chosen, flips, write

TEXT = '''"""A table."""
from enums import Mode
LIMIT = 3
ROWS = (("né", Mode.ON, True, 0.5, "two words", f"text {LIMIT}"), ("b", Mode.OFF))
def function():
    return 7
class Level(IntEnum):
    LOW = 1
    title: str = "not of the enumeration"
'''


def changes() -> dict[str, str]:
    return {f"{flip.line}: {flip.old}": flip.new for flip in flips("table.py", TEXT)}


def test_constants_of_tables_and_enumerations_are_changed_and_prose_and_code_are_not() -> None:
    assert changes() == {
        "3: 3": "4",
        '4: "né"': "'néx'",
        "4: Mode.ON": "Mode.OFF",
        "4: True": "False",
        "4: 0.5": "1.75",
        '4: "b"': "'bx'",
        "4: Mode.OFF": "Mode.ON",
        "8: 1": "2",
    }


def test_a_word_becomes_one_that_looks_alike_where_there_is_one() -> None:
    text = 'CODES = ("R141", "R142", "stop")'
    assert {flip.old: flip.new for flip in flips("table.py", text)} == {
        '"R141"': "'R142'",
        '"R142"': "'R141'",
        '"stop"': "'stopx'",
    }


def test_numbers_of_a_model_file_change_by_a_hundredth_and_its_prose_does_not() -> None:
    text = """# 3 lines
[links.wrist_1]
mass = { value = 1.5, why = "of 2 kg, say" }  # 7
com = { deg = [-200, 0, 1e-05] }
"""
    assert {f"{flip.line}: {flip.old}": flip.new for flip in flips("arm.toml", text)} == {
        "3: 1.5": "1.515",
        "4: -200": "-202",
        "4: 0": "0.01",
        "4: 1e-05": "1.01e-05",
    }


def test_a_change_stands_in_the_place_of_the_old_value() -> None:
    for flip in flips("table.py", TEXT):
        changed = applied(TEXT, flip)
        ast.parse(changed)
        assert len(changed) - len(TEXT) == len(flip.new) - len(flip.old)
        assert [old for old, new in zip(TEXT.split("\n"), changed.split("\n"), strict=True) if old != new] == [
            TEXT.split("\n")[flip.line - 1]
        ]


def test_a_seed_always_chooses_the_same_changes_of_every_file() -> None:
    assert chosen(1, 100, []) == chosen(1, 100, [])
    assert chosen(1, 100, []) != chosen(2, 100, [])
    assert {flip.file for flip in chosen(1, 100, [])} == set(TABLES)


def test_every_table_is_there() -> None:
    assert [file for file in TABLES if not (SOURCE / file).is_file()] == []


def test_a_changed_model_file_changes_the_module_that_is_read_in_its_place(tmp_path: Path) -> None:
    (tmp_path / "tables").mkdir()
    write(tmp_path / "arm.toml", "mass = { value = 1.5 }\n")
    space: dict[str, object] = {}
    exec((tmp_path / "tables" / "arm_toml.py").read_text(encoding="utf-8"), space)
    assert space["document"]() == {"mass": {"value": 1.5}}  # type: ignore[operator]
