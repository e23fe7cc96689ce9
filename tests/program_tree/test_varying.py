"""Trees in sweeps: variables of task and installation that are varied; and the pendant's own script of a tree."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript.cli.main import main
from elitescript.environment.program_file import source_of
from elitescript.errors import UsageError
from elitescript.program_tree import nodes, task_bytes
from elitescript.program_tree.cells import expression
from elitescript.program_tree.task import Task
from elitescript.sweep import sweep
from elitescript.sweep.making import make_plan
from elitescript.sweep.plans.plan_json import plan_data, plan_of
from elitescript.sweep.plans.trees import source_of_plan, tree_of
from elitescript.sweep.plans.variations import parse_variation
from elitescript.sweep.single import Runner
from elitescript.sweep.sweeping import is_random


@pytest.fixture
def cell(tmp_path: Path) -> Path:
    """A looping task that halts in its first turn after `t * k` seconds, with n counted up from nowhere."""
    children = (
        nodes.Assignment(variable="t", value=expression("0.5")),
        nodes.ScriptLine(type_name="Script", statement=expression("sleep(t * k)")),
        nodes.Assignment(variable="n", value=expression("n + 1")),
        nodes.If(condition=expression("k > 3"), children=(nodes.Assignment(variable="late", value=expression("1")),)),
        nodes.Halt(),
    )
    main_task = nodes.MainTask(type_name="Robot Main Task", loops=True, children=children)
    path = tmp_path / "cell.task"
    path.write_bytes(task_bytes(Task("cell", "inst", "CS612", parts=(nodes.InitVariables(), main_task))))
    (tmp_path / "inst.configuration").write_text("<ConfigurationSettings/>")
    (tmp_path / "inst.configuration.variables").write_text(
        '<VariablesManager><Variable name="k" value="1.0"/><Variable name="p" value="[1.0, 2.0]"/></VariablesManager>'
    )
    return path


def runner(cell: Path, *variations: str, is_generated: bool = False) -> Runner:
    rows = [parse_variation(text) for text in variations]
    return Runner(make_plan(cell, variations=rows, measures={"n": 'globals["n"]'}, is_generated=is_generated))


class TestVaried:
    def test_variables_of_task_and_installation(self, cell: Path) -> None:
        run = runner(cell, "task.t=choice(0.2)", "installation.k=choice(2.0)", "task.n=choice(5)")
        row = run.run(run.choices_of(0))
        assert row.state == "stopped"
        assert row.time_s == pytest.approx(0.4)
        assert row.measures["n"] == 6
        assert row.choices.values == {"task.t": 0.2, "installation.k": 2.0, "task.n": 5}

    def test_an_element_of_a_list(self, cell: Path) -> None:
        run = runner(cell, "installation.p[1]=choice(7.0)", "task.n=choice(1)")
        assert run.run(run.choices_of(0)).state == "stopped"

    @pytest.mark.parametrize(
        ("name", "words"),
        [
            ("task.q", "the task has no variable q; it has t, n, late"),
            ("task.k", "the task has no variable k; is installation.k meant?; it has t, n, late"),
            ("installation.t", "the installation has no variable t; is task.t meant?; it has k, p"),
            ("installation.kk", "has no variable kk; did you mean 'k'?"),
            ("installation.p[5]", "p has 2 elements, from 0 on"),
            ("task.late", r"6 If > 7 Assignment .*assigns to late within a loop, a condition"),
            ("nothing", "the program has no such name; it has installation.k, installation.p, task.t"),
        ],
    )
    def test_refused_by_name(self, cell: Path, name: str, words: str) -> None:
        with pytest.raises(UsageError, match=words.replace("?", r"\?").replace("[", r"\[")):
            runner(cell, f"{name}=uniform(0, 1)")

    def test_a_script_has_neither(self, tmp_path: Path) -> None:
        (tmp_path / "a.script").write_text("sleep(1)\n")
        with pytest.raises(UsageError, match="is no graphical program"):
            runner(tmp_path / "a.script", "task.t=uniform(0, 1)")

    def test_the_plan_keeps_the_tree(self, cell: Path) -> None:
        plan = make_plan(cell, variations=[parse_variation("task.t=uniform(0, 1)")])
        assert plan.options["model"] == "CS612"
        assert plan_of(plan_data(plan)) == plan
        source, kept = source_of(cell), source_of_plan(plan)
        assert (kept.places, kept.notes, kept.tree) == (source.places, source.notes, source.tree)
        assert is_random(plan)
        for wrong in (
            [],
            {"places": []},
            {**plan.tree, "places": [["a", 10**9]]},
            {**plan.tree, "notes": [["X", 1, "", ""]]},
        ):
            with pytest.raises(UsageError, match=r"plan\.tree: this is no tree"):
                tree_of(wrong, "plan.tree")

    def test_failures_name_nodes(self, cell: Path) -> None:
        found = sweep(cell, vary={"task.t": [0.1, 0.2]}, runs=2, jobs=1)
        assert "alarm R100 in 2 Robot Main Task > 5 Assignment (script line" in str(found)


class TestGenerated:
    def test_the_script_of_the_pendant_runs(self, cell: Path, capsys: pytest.CaptureFixture[str]) -> None:
        assert main(["run", str(cell), "--generated"]) == 2
        assert "cell.task.script, which the pendant writes beside a task, is not there" in capsys.readouterr().err
        beside = cell.with_name("cell.task.script")
        assert main(["task", str(cell), "-o", str(beside)]) == 0
        beside.write_text(beside.read_text().replace("t = 0.5", "t = 0.7"))
        assert main(["run", str(cell), "--generated", "--set", "n=1"]) == 0
        assert "     0.700 s  stopped" in capsys.readouterr().out
        assert main(["run", str(cell), "--set", "n=1"]) == 0
        assert "     0.500 s  stopped" in capsys.readouterr().out
        assert main(["run", str(cell), "--generated"]) == 1
        assert "in 2 Robot Main Task > 5 Assignment (script line" in capsys.readouterr().err
        run = runner(cell, "task.n=choice(5)", is_generated=True)
        assert run.run(run.choices_of(0)).time_s == pytest.approx(0.7)

    def test_its_nodes_are_those_of_its_marks(self, tmp_path: Path) -> None:
        (tmp_path / "old.task").write_text("<EliTask><broken></EliTask>")
        (tmp_path / "old.task.script").write_text(
            'def old():\n  while (True):\n    $ LINE: (1, "Robot Main Task")\n    $ LINE: (2, "Loop \\"a\\"")\n'
            '    while (True):\n      $ LINE: (3, "W1", "after")\n      sync()\n    end\n    sync()\n  end\nend\n'
        )
        source = source_of(tmp_path / "old.task", is_generated=True)
        loop = '2 Loop "a"'
        here = ["", "", "1 Robot Main Task", loop, loop, "3 W1", "3 W1", loop, loop, "", "", ""]
        assert list(source.places) == here

    def test_other_programs_have_none(self, tmp_path: Path) -> None:
        (tmp_path / "a.script").write_text("sleep(1)\n")
        with pytest.raises(UsageError, match="is no graphical program"):
            source_of(tmp_path / "a.script", is_generated=True)
