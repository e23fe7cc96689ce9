"""The text of point files."""

from __future__ import annotations

from array import array
from math import pi
from random import Random
from typing import Any

import pytest

from elitescript.commands import micro_file
from elitescript.commands.micro_file import read_points
from elitescript.errors import InvalidValueError


def read(text: str | bytes, *, is_cartesian: bool = False, is_degrees: bool = False) -> tuple[Any, Any]:
    data = text.encode() if isinstance(text, str) else text
    numbers, lines = read_points(data, "path.txt", is_cartesian=is_cartesian, is_degrees=is_degrees)
    return array("d", numbers).tolist(), array("I", lines).tolist()


def refused(text: str | bytes) -> InvalidValueError:
    with pytest.raises(InvalidValueError) as caught:
        read(text)
    assert caught.value.code == "R104"
    return caught.value


ONE = [1.0, -2.5, 0.003, 4.0, 5.0, 6.0]


@pytest.mark.parametrize(
    "text",
    [
        "1 -2.5 3e-3 4 5 6",
        "1,-2.5,3e-3,4,5,6\n",
        "1, -2.5,\t3e-3 ,4 5\t6\n",
        "  1   -2.5 .003 4. +5 6  \r\n",
        "\ufeff1 -2.5 0.003 4 5 6",
        "1,-2.5,0.003,4,5,6,\n",
        "1 -2.5 0.003 4 5 6 # the only one, of 1_000",
        "1 -2.5 0.003 4 5 6 #,,\n",
    ],
)
def test_six_numbers_are_a_point(text: str) -> None:
    assert read(text) == (ONE, [1])


def test_lines_without_a_point_are_skipped_and_counted() -> None:
    text = "# made by hand\n\n1 2 3 4 5 6\n   \t\n  # next\n7 8 9 10 11 12\n\n"
    assert read(text) == ([float(k) for k in range(1, 13)], [3, 6])


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_any_line_end(end: str) -> None:
    assert read(end.join(["1 2 3 4 5 6"] * 3)) == ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0] * 3, [1, 2, 3])


def test_units() -> None:
    text = "180 90 0 -90 360 1"
    assert read(text, is_degrees=True)[0] == pytest.approx([pi, pi / 2, 0.0, -pi / 2, 2 * pi, pi / 180])
    assert read(text, is_degrees=True, is_cartesian=True)[0] == [0.18, 0.09, 0.0, -90.0, 360.0, 1.0]
    assert read(text, is_cartesian=True)[0] == [180.0, 90.0, 0.0, -90.0, 360.0, 1.0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 2 3 4 5 6\n1 2 3 4 5\n", "path.txt, line 2: six numbers are needed, there are 5"),
        ("\n1 2 3 4 5 6 7\n", "path.txt, line 2: six numbers are needed, there are 7"),
        ("1 2 3 4 5 6\n1 2 x 4 5 6\n", "path.txt, line 2, column 5: 'x' is not a number"),
        ("1, 2, 3, 4, 5, six # 6\n", "path.txt, line 1, column 16: 'six' is not a number"),
        ("1 2 3 4 5 nan\n", "path.txt, line 1, column 11: 'nan' is not a finite number"),
        ("# x\n1 2 -inf 4 5 6\n", "path.txt, line 2, column 5: '-inf' is not a finite number"),
        ("1 2 3 4 5 1e999\n", "path.txt, line 1, column 11: '1e999' is not a finite number"),
        ("1,2,,4,5,6\n", "path.txt, line 1, column 5: a number is missing next to the comma"),
        ("1 2 3 4 5 6\n,1,2,3,4,5,6\n", "path.txt, line 2, column 1: a number is missing next to the comma"),
        (",1,2,3,4,5,6\n", "path.txt, line 1, column 1: a number is missing next to the comma"),
        ("1,2,3, ,4,5,6\n", "path.txt, line 1, column 7: a number is missing next to the comma"),
        ("1 2 3 4 5 1_0\n", "path.txt, line 1, column 11: '1_0' is not a number"),
        ("[1, 2, 3, 4, 5, 6]\n", "path.txt, line 1, column 1: '[1' is not a number"),
        ("1;2;3;4;5;6\n", "path.txt, line 1, column 1: '1;2;3;4;5;6' is not a number"),
        (f"1 2 3 4 5 {'9' * 50}x\n", "path.txt, line 1, column 11: '999999999999999999999...' is not a number"),
        ("", "path.txt holds no point"),
        ("# nothing\n\n", "path.txt holds no point"),
        (b"1 2 3 4 5 6\n1 2 3 \xff 5 6\n", "path.txt, line 2: the text is not UTF-8"),
        ("1 2 3 4 5 6\n".encode("utf-16"), "path.txt, line 1: the text is not UTF-8"),
    ],
)
def test_what_is_wrong_is_located(text: str | bytes, message: str) -> None:
    assert str(refused(text)).startswith(message)


def test_the_first_mistake_is_the_one_reported() -> None:
    assert "line 1, column 3: 'a'" in str(refused("1 a 3 4 5 6\n1 2\n"))
    assert "line 1: six numbers" in str(refused("1 2\n1 a 3 4 5 6\n"))


def test_decimal_commas_are_recognised() -> None:
    assert "0.5, not with a comma" in (refused("0,5 1,2 0,1 3,0 0,2 1,1\n").hint or "")


def test_too_many_points_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(micro_file, "POINTS_MAX", 3)
    assert len(read("1 2 3 4 5 6\n" * 3)[1]) == 3
    assert "line 5, column 1: 'x'" in str(refused("1 2 3 4 5 6\n" * 2 + "\n\nx 2 3 4 5 6\n"))
    assert "line 5: six numbers" in str(refused("1 2 3 4 5 6\n" * 4 + "1 2\n"))
    assert "holds 4 points" in str(refused("1 2 x 4 5 6\n" * 4))
    error = refused("1 2 3 4 5 6\n" * 4)
    assert "holds 4 points; at most 3" in str(error)
    assert error.limit == "<= 3"


def test_a_hundred_thousand_lines_are_read() -> None:
    data = ("-0.123456, 1.234567, -2.345678, 0.000001, 1.500000, -3.141593\n" * 100_000).encode()
    numbers, _ = read_points(data, "path.txt", is_cartesian=False, is_degrees=True)
    assert len(numbers) == 48 * 100_000


def plainly_read(text: str) -> tuple[list[float], list[int]]:
    """Line by line, number by number."""
    numbers, lines = [], []
    for number, line in enumerate(text.lstrip("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
        words = line.partition("#")[0].replace(",", " ").split()
        if words:
            numbers += [float(word) for word in words]
            lines.append(number)
    return numbers, lines


@pytest.mark.parametrize("seed", range(20))
def test_any_text_is_read_whole_or_refused(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    chance = Random(seed)
    monkeypatch.setattr(micro_file, "_BATCH", 1 + seed % 4)
    outcomes = set()
    for _ in range(200):
        rows = [
            chance.choice((" ", ",", ", ", "\t")).join(f"{chance.uniform(-9, 9):.3f}" for _ in range(6))
            for _ in range(4)
        ]
        text = list("\n".join(rows))
        for _ in range(chance.randrange(3)):
            text[chance.randrange(len(text))] = chance.choice(" ,\n\r\t#.-e_x1\0\x0b\x85\u2028\ufeff\u0661")
        try:
            numbers, lines = read("".join(text))
        except InvalidValueError as error:
            assert str(error).startswith("path.txt, line ")
            outcomes.add("refused")
        else:
            assert (numbers, lines) == plainly_read("".join(text))
            assert len(numbers) == 6 * len(lines)
            outcomes.add("read")
    assert outcomes == {"read", "refused"}
