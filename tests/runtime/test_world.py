import pytest

from elitescript.errors import ArgumentTypeError, ScriptPermissionError
from elitescript.runtime.environment import TASK_PATH, EmptyEnvironment, FilesRefused, relative_name


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("points.csv", "points.csv"),
        (TASK_PATH + "points.csv", "points.csv"),
        (TASK_PATH + "/points.csv", "points.csv"),
        ("//task//a//b.txt", "a/b.txt"),
        ("./a/./b", "a/b"),
        ("a/../b", "b"),
        ("/task/a/../b", "b"),
        ("a\\b", "a/b"),
        ("/task", ""),
        (TASK_PATH, ""),
        (".", ""),
        ("", ""),
        ("坐标.txt", "坐标.txt"),
        ("..a/b..", "..a/b.."),
    ],
)
def test_names_of_the_task_folder(path, name):
    assert relative_name(path) == name


@pytest.mark.parametrize(
    "path",
    ["/etc/hostname", "..", "../x", "a/../../x", "/task/../etc", "/tasks/x", "/task/../../x", "C:\\x", "c:x", "/",
     "a\0b", "\\etc\\x", "~/../../x"],
)  # fmt: skip
def test_names_that_lead_out_are_refused(path):
    with pytest.raises(ScriptPermissionError) as refusal:
        relative_name(path)
    assert isinstance(refusal.value, PermissionError)
    assert refusal.value.code == "R123"


@pytest.mark.parametrize("path", [0, 1.5, b"x", None, ["x"]])
def test_a_name_is_a_str(path):
    with pytest.raises(ArgumentTypeError, match="must be a str"):
        relative_name(path)


def test_a_str_that_can_lie_is_refused():
    class Lying(str):
        def replace(self, *args):
            return "/etc/passwd"

    with pytest.raises(ArgumentTypeError):
        relative_name(Lying("x"))


def test_a_world_of_nothing_refuses_files():
    files = EmptyEnvironment().files
    assert isinstance(files, FilesRefused)
    for call in (
        lambda: files.open("x", "r", "utf-8", None),
        lambda: files.size("x"),
        lambda: files.remove("x"),
        lambda: files.make_folder("x"),
    ):
        with pytest.raises(ScriptPermissionError, match="no task folder"):
            call()
    assert (files.kind(""), files.kind("x"), files.names("")) == ("folder", "", [])
