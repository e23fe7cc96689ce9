import pytest

from elitescript.environment.program_file import neighbours, source_of
from elitescript.errors import UsageError
from elitescript.robot import VirtualRobot


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cell.script").write_text("textmsg('hello')\n")
    return tmp_path


@pytest.mark.parametrize("name", ["cell.scrpt", "cell", "cel.script", "./cell.scrpt", "Cell.script", "cell.txt"])
def test_a_mistyped_file_is_no_program_text(folder, name):
    with pytest.raises(UsageError, match=r"^cannot read .*; is cell\.script meant\?$"):
        VirtualRobot().run(name)


@pytest.mark.parametrize("name", ["jobs/cell.script", "jobs/cell", "my jobs/cell", "nothing.like.it", "../x/y"])
def test_a_path_to_nothing_is_refused_too(folder, name):
    with pytest.raises(UsageError, match=r"^cannot read "):
        source_of(name)


def test_a_file_of_any_name_can_be_read(folder):
    (folder / "other").write_text("textmsg(1)\n")
    assert source_of("other").text == "textmsg(1)\n"
    assert source_of(folder / "cell.script").name.endswith("cell.script")


@pytest.mark.parametrize(
    "text",
    [
        "textmsg('hi')",
        "movej([0, -1.57, 1.57, 0, 1.57, 0])",
        "x = 1",
        "x = 1/2",
        "a, b = 1, 2",
        "pass",
        "1",
        "'text'",
        "# cell.scrpt",
        "import math",
        "",
        "cell.scrpt\n",
        "global x; x = 3",
        "socket_open('10.0.0.1', 5000)",
        'popup("a/b")',
    ],
)
def test_a_line_of_program_stays_one(folder, text):
    assert source_of(text).text == text


def test_the_file_nearby_is_named(folder):
    assert neighbours(folder / "cell.scrpt") == f"is {folder / 'cell.script'} meant?"
    assert neighbours(folder / "quite_different") == ""
    assert neighbours(folder / "no" / "cell.script") == ""
