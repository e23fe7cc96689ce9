"""Where the root of the repository is, and paths from there."""

from __future__ import annotations

import os

import pytest

from elitescript.environment.repository import WORKSPACE, from_root, repository_root


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder `repo/robot`, which is the working directory."""
    folder = tmp_path / "repo" / "robot"
    folder.mkdir(parents=True)
    monkeypatch.chdir(folder)
    return folder


def test_without_a_repository_it_is_the_working_directory(here):
    assert repository_root({}) == here


def test_it_is_the_top_of_the_git_work_tree(here):
    (here.parent / ".git").mkdir()
    assert repository_root({}) == here.parent


def test_the_git_folder_of_a_second_work_tree_is_a_file(here):
    (here.parent / ".git").write_text("gitdir: /elsewhere\n")
    assert repository_root({}) == here.parent


def test_the_workspace_of_the_runner_goes_first(here):
    (here / ".git").mkdir()
    assert repository_root({WORKSPACE: str(here.parent)}) == here.parent


def test_also_with_dots_and_through_links(here, tmp_path):
    (tmp_path / "link").symlink_to(here.parent)
    assert repository_root({WORKSPACE: f"{here}/.."}) == here.parent
    assert repository_root({WORKSPACE: str(tmp_path / "link")}) == here.parent


@pytest.mark.parametrize("text", ["", "robot", "/there/is/none", "a\0b"])
def test_a_workspace_that_is_no_folder_says_nothing(here, text):
    assert repository_root({WORKSPACE: text}) == here


class TestPaths:
    def test_they_are_relative_to_the_root(self, here):
        assert from_root("bad.script", here.parent).as_posix() == "robot/bad.script"
        assert from_root(here / "bad.script", here.parent).as_posix() == "robot/bad.script"
        assert from_root("../robot/./bad.script", here.parent).as_posix() == "robot/bad.script"

    def test_they_are_absolute_outside(self, here, tmp_path):
        assert from_root("../../other.script", here.parent) == tmp_path / "other.script"

    def test_a_link_is_what_it_leads_to_in_the_repository(self, here):
        (here / "alias.script").symlink_to("bad.script")
        assert from_root("alias.script", here.parent).as_posix() == "robot/bad.script"

    def test_a_link_to_the_outside_is_itself(self, here, tmp_path):
        (tmp_path / "far.script").write_text("")
        (here / "alias.script").symlink_to(tmp_path / "far.script")
        assert from_root("alias.script", here.parent).as_posix() == "robot/alias.script"

    def test_through_a_link_to_the_repository(self, here, tmp_path):
        (tmp_path / "link").symlink_to(here.parent)
        assert from_root(tmp_path / "link" / "robot" / "bad.script", here.parent).as_posix() == "robot/bad.script"

    def test_links_that_go_round_have_a_path(self, here):
        (here / "a.script").symlink_to("a.script")
        assert from_root("a.script", here.parent).as_posix() == "robot/a.script"

    def test_the_root_of_the_file_system_is_a_root(self, here):
        assert os.fspath(from_root("x.script", type(here)("/"))) == str(here / "x.script").removeprefix("/")
