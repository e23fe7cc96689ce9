import os

import pytest

from elitescript.errors import UsageError
from elitescript.mcp.folder import Folder


@pytest.fixture
def folder(tmp_path):
    inside = tmp_path / "cell"
    (inside / "parts").mkdir(parents=True)
    (inside / ".git").mkdir()
    (inside / "a.script").write_text("")
    (inside / "parts" / "b.script").write_text("")
    (inside / ".git" / "c.script").write_text("")
    (tmp_path / "secret.script").write_text("")
    return Folder(inside)


def test_a_file_inside_is_found_by_relative_and_absolute_name(folder):
    for name in ("a.script", "./a.script", "parts/../a.script", str(folder.path / "a.script")):
        assert folder.file(name, ".script") == folder.path / "a.script"


@pytest.mark.parametrize("name", ["../secret.script", "parts/../../secret.script", "/etc/passwd", "~/x.script", ""])
def test_a_file_outside_is_refused(folder, name):
    with pytest.raises(UsageError):
        folder.file(name, ".script")


def test_a_link_that_leads_outside_is_refused(folder):
    (folder.path / "link.script").symlink_to(folder.path.parent / "secret.script")
    with pytest.raises(UsageError, match="outside"):
        folder.file("link.script", ".script")


def test_a_folder_behind_a_link_that_leads_outside_is_refused(folder):
    (folder.path / "up").symlink_to(folder.path.parent)
    with pytest.raises(UsageError, match="outside"):
        folder.file("up/secret.script", ".script")


@pytest.mark.parametrize("name", ["parts", "nothing.script", "a\0.script", "x" * 5000 + ".script"])
def test_what_is_no_file_is_refused(folder, name):
    with pytest.raises(UsageError):
        folder.file(name, ".script")


def test_a_file_of_another_kind_is_refused(folder):
    (folder.path / "key.pem").write_text("")
    with pytest.raises(UsageError, match="suffix"):
        folder.file("key.pem", ".script", ".toml")


def test_a_name_in_capitals_is_a_program_too(folder):
    (folder.path / "CELL.SCRIPT").write_text("")
    assert folder.programs(10)[0] == ["CELL.SCRIPT", "a.script", "parts/b.script"]
    assert folder.file("CELL.SCRIPT", ".script").name == "CELL.SCRIPT"


def test_programs_are_listed_by_name_without_hidden_folders(folder):
    assert folder.programs(10) == (["a.script", "parts/b.script"], 2)
    assert folder.programs(1) == (["a.script"], 2)


def test_a_folder_must_be_one(tmp_path):
    with pytest.raises(UsageError, match="no folder"):
        Folder(tmp_path / "nothing")


def test_a_program_is_found_by_the_name_that_it_is_listed_by(tmp_path):
    inside, outside = tmp_path / "in", tmp_path / "out.script"
    inside.mkdir()
    outside.write_text("")
    name = os.fsdecode(b"b\xe9d.script")
    (inside / name).write_text("")
    (inside / os.fsdecode(b"l\xe9.script")).symlink_to(outside)
    folder = Folder(inside)
    assert folder.programs(9) == ([r"b\udce9d.script", r"l\udce9.script"], 2)
    assert folder.file(r"b\udce9d.script", ".script") == folder.path / name
    with pytest.raises(UsageError, match="is outside"):
        folder.file(r"l\udce9.script", ".script")
