"""What is drawn: by seed, number and name alone."""

from __future__ import annotations

from statistics import NormalDist, fmean, pstdev

import pytest

from elitescript.errors import UsageError
from elitescript.sweep.plans.plan import Variation
from elitescript.sweep.plans.seeds import normal_quantile, seed_of_run
from elitescript.sweep.plans.variations import Draw, check_names, extremes, grid_size, parse_variation, plain_value


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("r=uniform(0, 1)", Variation("r", "uniform", (0, 1))),
        (" box.0.x = normal(0.4,1e-3)", Variation("box.0.x", "normal", (0.4, 1e-3))),
        ("standard_digital_in[3]=choice(true,off)", Variation("standard_digital_in[3]", "choice", (True, False))),
        ("m=choice('a,(b', red, 2, [1, 2])", Variation("m", "choice", ("a,(b", "red", 2, [1, 2]))),
        ("n=grid(1, 5, 5)", Variation("n", "grid", (1, 5, 5))),
    ],
)
def test_forms(text: str, expected: Variation) -> None:
    assert parse_variation(text) == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("r", "write NAME=KIND"),
        ("r=0.5", "'0.5' is no kind of variation"),
        ("r=unifrom(0,1)", "did you mean 'uniform'"),
        ("r=uniform(0,1", "with both brackets"),
        ("r=uniform(0)", "1 value given; write uniform"),
        ("r=uniform(1,0)", "1 is above 0"),
        ("r=uniform(0,x)", "'x' is no number"),
        ("r=uniform(0,true)", "True is no number"),
        ("r=uniform(0,1e999)", "inf is no number"),
        ("r=normal(0,-1)", "deviation is -1"),
        ("r=choice()", "nothing to choose from"),
        ("r=grid(0,1,0)", "0 points"),
        ("r=grid(0,1,2.0)", "2.0 points"),
        ("r=choice(a b)", "'a b' is no literal"),
    ],
)
def test_what_makes_no_sense_is_refused(text: str, message: str) -> None:
    with pytest.raises(UsageError, match=message.replace("(", r"\(")) as caught:
        parse_variation(text)
    assert str(caught.value).startswith(f"--vary {text}: ")


def test_a_name_is_varied_once_and_grids_end() -> None:
    row = parse_variation("r=uniform(0,1)")
    with pytest.raises(UsageError, match="twice"):
        check_names([row, row])
    with pytest.raises(UsageError, match="points"):
        check_names([Variation("a", "grid", (0, 1, 10**7)), Variation("b", "grid", (0, 1, 10**7))])


def test_a_run_is_drawn_from_seed_number_and_name_alone() -> None:
    r, s = parse_variation("r=uniform(2,3)"), parse_variation("s=choice(1,2,3)")
    both = [Draw((s, r), 7).values(run) for run in (5, 0, 99)]
    assert [values["r"] for values in both] == [Draw((r,), 7).values(run)["r"] for run in (5, 0, 99)]
    assert Draw((r,), 7).values(5) != Draw((r,), 8).values(5)
    # Written down once: rows of earlier versions stay what they were.
    assert seed_of_run(0, 0) == 2993405329634522
    assert Draw((r,), 0).values(0) == {"r": 2.6464194191946488}


def test_grids_go_on_as_nested_loops_do() -> None:
    variations = [parse_variation("a=grid(0,1,3)"), parse_variation("u=uniform(0,1)"), parse_variation("b=grid(1,3,2)")]
    draw = Draw(variations, 1)
    points = [(values["a"], values["b"]) for values in map(draw.values, range(7))]
    assert points == [(0.0, 1), (0.0, 3), (0.5, 1), (0.5, 3), (1.0, 1), (1.0, 3), (0.0, 1)]
    assert grid_size(variations) == 6
    assert [Draw([parse_variation("n=grid(2,8,4)")], 0).values(run)["n"] for run in range(4)] == [2, 4, 6, 8]
    assert Draw([parse_variation("n=grid(2,8,1)")], 0).values(3)["n"] == 2


def test_distributions_are_what_they_say() -> None:
    draw = Draw(
        [parse_variation("u=uniform(-1,3)"), parse_variation("n=normal(5,2)"), parse_variation("c=choice(a,b)")], 3
    )
    rows = [draw.values(run) for run in range(4000)]
    uniform, normal = [row["u"] for row in rows], [row["n"] for row in rows]
    assert -1 <= min(uniform) < -0.99
    assert 2.99 < max(uniform) <= 3
    assert fmean(uniform) == pytest.approx(1, abs=0.06)
    assert fmean(normal) == pytest.approx(5, abs=0.1)
    assert pstdev(normal) == pytest.approx(2, abs=0.1)
    assert 1800 < [row["c"] for row in rows].count("a") < 2200


def test_the_normal_quantile_is_that_of_the_standard_library() -> None:
    exact = NormalDist()
    for p in (1e-16, 1e-9, 0.001, 0.02424, 0.02426, 0.3, 0.5, 0.7, 0.97574, 0.97576, 0.999, 1 - 1e-12):
        assert normal_quantile(p) == pytest.approx(exact.inv_cdf(p), rel=1e-8, abs=1e-9)


def test_plain_values_and_ends() -> None:
    rows = [parse_variation(text) for text in ("a=uniform(1,2)", "b=normal(3,1)", "c=choice(x,y)", "d=grid(4,5,2)")]
    assert [plain_value(row) for row in rows] == [1.5, 3, "x", 4]
    assert [extremes(row) for row in rows] == [(1, 2), (3,), ("x", "y"), (4, 5)]
