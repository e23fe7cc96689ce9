"""Growth tables: every step runs at its smallest size, and the exponents mean what they say."""

from __future__ import annotations

import pytest

from benchmarks import growth
from benchmarks.growth import Figure
from benchmarks.table import Time


@pytest.mark.parametrize("name", ["robots", "programs", "checks", "straight", "worlds"])
def test_a_table_has_the_same_figures_at_each_size(name: str) -> None:
    measure, _, _ = growth.TABLES[name]
    small, larger = list(measure(1)), list(measure(2))
    assert [figure.what for figure in small] == [figure.what for figure in larger]
    assert all(figure.amount is not None or figure.time.cpu_s > 0.0 for figure in small)


def test_rows_are_shares_of_one_and_the_exponent_is_that_of_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    def measured(_: str, size: int) -> list[Figure]:
        quadratic = Figure("sort", Time(size**2 * 2e-6, size**2 * 1e-6 + size * 1e-5), size * 1e-5)
        return [quadratic, Figure("memory", amount=size * 3.0)]

    monkeypatch.setattr(growth, "_measured", measured)
    monkeypatch.setitem(growth.TABLES, "things", (growth.robots, (1, 10, 100), "thing"))
    rows = {row.what: row for row in growth.table("things")}
    assert rows["things, 100: sort, of one thing"].cpu_s == pytest.approx(1.1e-4)
    assert rows["things, 100: sort, of one thing"].words == "of it 9% garbage collector"
    assert rows["things: growth of sort"].value == pytest.approx(2.0)
    assert rows["things, 100: memory, of one thing"].value == 3.0
    assert rows["things: growth of memory"].value == pytest.approx(1.0)


def test_one_size_alone_has_no_growth(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(growth, "_measured", lambda *_: [Figure("run", Time(2.0, 1.0)), Figure("kept", amount=3.0)])
    monkeypatch.setitem(growth.TABLES, "things", (growth.robots, (1,), "thing"))
    assert [row.what for row in growth.table("things")] == [
        "things, 1: run, of one thing",
        "things, 1: kept, of one thing",
    ]
