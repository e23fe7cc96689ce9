"""Functions over time against the rows of every tick, on random programs and random expressions."""

from random import Random

import pytest

from elitescript import PlantConfig, VirtualRobot
from elitescript.properties.checks import Checks
from elitescript.properties.parsing import parse_measure, parse_property
from tests.invariants.random_programs import random_program
from tests.properties import oracle

UNTIL_S = 30


def measured(program, properties, measures=(), **options):
    """Run a program; return its results."""
    checks = Checks([parse_property(text) for text in properties], {text: parse_measure(text) for text in measures})
    watching = checks.watch()
    run = VirtualRobot("CS66", **options).run(program, trace=watching.trace, until_s=UNTIL_S)
    return watching.results(run)


def compare(seed, count, **options):
    """Compare random expressions over one random program with the oracle; return how many held."""
    rng = Random(seed)
    program = random_program(rng)
    robot = VirtualRobot("CS66", **options)
    rows = list(robot.run(program, trace=True, trace_signals="standard_digital_out", until_s=UNTIL_S).trace)
    arm = robot.controller.arm
    formulas = [oracle.random_formula(rng, arm, rows[-1].t) for _ in range(count)]
    names = [rng.choice(("always", "eventually")) for _ in formulas]
    pairs = [(rng.choice(formulas), rng.choice(formulas)) for _ in formulas]
    numbers = [oracle.random_number(rng, arm, rows[-1].t) for _ in formulas]
    properties = [f"{name}({formula.text})" for name, formula in zip(names, formulas, strict=True)]
    befores = [f"before({first.text}, {second.text})" for first, second in pairs]
    measures = {
        f"{name}({formula.text})": (name, formula) for formula in formulas for name in ("first", "duration", "count")
    }
    extremes = {f"{name}({text})": (name, value) for text, value, _, _ in numbers for name in ("max_of", "min_of")}

    results = measured(program, [*properties, *befores], [*measures, *extremes], **options)

    verdicts = results.verdicts
    for text, name, formula, verdict in zip(properties, names, formulas, verdicts, strict=False):
        holds = (all if name == "always" else any)(formula.holds(row) for row in rows)
        assert verdict.holds is holds, (seed, text, verdict)
        margins = oracle.expected_margins(name, formula, rows)
        found = verdict.margins or ({} if verdict.margin is None else {verdict.unit: verdict.margin})
        found = {"line" if unit in ("", "line") else unit: margin for unit, margin in found.items()}
        assert found == pytest.approx(margins, abs=1e-12), (seed, text)
    for text, (first, second), verdict in zip(befores, pairs, verdicts[len(properties) :], strict=True):
        a, b = oracle.first_time(first, rows), oracle.first_time(second, rows)
        assert verdict.holds is (b is None or (a is not None and a <= b)), (seed, text)
    for text, (name, formula) in measures.items():
        assert results.measures[text] == pytest.approx(oracle.expected_number(name, formula, rows)), (seed, text)
    for text, (name, value) in extremes.items():
        extreme = (max if name == "max_of" else min)(map(value, rows))
        assert results.measures[text] == pytest.approx(extreme, abs=1e-12), (seed, text)
    return sum(verdict.holds for verdict in verdicts)


@pytest.mark.parametrize("seed", range(2))
def test_random_expressions_come_to_what_every_tick_says(seed):
    assert compare(seed, 8) > 0


def test_a_function_over_time_of_what_never_changes_sees_the_whole_run():
    program = "def p():\n  sleep(0.5)\nend"
    measures = ["duration(True)", "count(1 < 2)", "first(True)", "max_of(3)"]
    results = measured(
        program, ["always(1 > 2)", "eventually(1 < 2)", "before(True, False)", "not always(False)"], measures
    )
    assert [verdict.holds for verdict in results.verdicts] == [False, True, True, True]
    assert [results.measures[text] for text in measures] == [0.5, 1, 0.0, 3]


def test_what_never_holds_has_no_time():
    verdict = measured("def p():\n  sleep(0.1)\nend", ['first(signal("standard_digital_out[5]")) > 3']).verdicts[0]
    assert (verdict.holds, verdict.t) == (False, None)
    assert verdict.words == 'signal("standard_digital_out[5]") never holds'


def test_an_arm_that_lags_is_seen_as_its_target():
    assert compare(7, 5, plant=PlantConfig(lag_s=0.02)) > 0


@pytest.mark.invariants
@pytest.mark.slow
@pytest.mark.parametrize("block", range(10))
def test_many_random_expressions_come_to_what_every_tick_says(block):
    for seed in range(1000 + 12 * block, 1012 + 12 * block):
        compare(seed, 10)


def test_signals_and_elements_have_the_same_names_inside():
    program = "def f():\n  movej([0.3, -1.5, -1.6, -1.5, 1.5, 0])\n  set_standard_digital_out(0, True)\nend\n"
    pairs = [
        ("first(standard_digital_out[0])", 'first(signal("standard_digital_out[0]"))'),
        ("max_of(q.base)", "max_of(q[0])"),
        ("min_of(tcp.z)", "min_of(tcp[2])"),
        ("max_of(abs(qd.shoulder))", "max_of(abs(qd[1]))"),
        ("max_of(tool_analog_in)", 'max_of(signal("tool_analog_in"))'),
    ]
    results = measured(program, [], [text for pair in pairs for text in pair]).measures
    for one, other in pairs:
        assert results[one] == results[other], one
    assert results["max_of(q.base)"] == pytest.approx(0.3)
