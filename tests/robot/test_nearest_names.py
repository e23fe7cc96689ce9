"""Names that are not there: the refusal of a keyword or attribute says which is meant."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.testing.world import World


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: VirtualRobot(wold=1), "got an unexpected keyword argument 'wold'; did you mean 'world'"),
        (lambda: VirtualRobot(modle="CS66"), "did you mean 'model'"),
        (lambda: VirtualRobot().run("", until=3), r"run\(\) has no argument 'until'; did you mean 'until_s'"),
        (lambda: VirtualRobot().start("", preset={}), r"start\(\) has no argument 'preset'; did you mean 'presets'"),
        (lambda: World(wire=[]), r"World.__init__\(\) has no argument 'wire'; did you mean 'wires'"),
    ],
)
def test_a_keyword_that_is_not_there_names_the_nearest(call, words):
    with pytest.raises(TypeError, match=words):
        call()


def test_an_error_of_what_is_called_is_its_own():
    with pytest.raises(TypeError, match="device names") as caught:
        World(devices=_of_another_kind())
    assert "argument" not in str(caught.value)


def _of_another_kind():
    raise TypeError("device names")
    yield


def test_names_that_a_run_does_not_have_name_the_nearest():
    run = VirtualRobot("CS66").run("def p():\n  global picked\n  picked = 3\nend\n")
    with pytest.raises(KeyError, match="no global is called 'piked'; did you mean 'picked'"):
        run.globals["piked"]
    with pytest.raises(KeyError, match="no global is called 'xyz'; there are picked"):
        run.globals["xyz"]
    with pytest.raises(AttributeError, match="'Run' object has no attribute 'warning'; did you mean 'warnings'"):
        print(run.warning)
    assert not hasattr(run, "verdict_")
