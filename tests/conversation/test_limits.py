"""How much of a run a page is given, in numbers typed by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript.conversation import limits
from elitescript.conversation.limits import EventBudget, bounded, cut_name, size_of


def log(n: int, text: str = "") -> dict[str, object]:
    return {"type": "log", "t": float(n), "text": text}


class TestBounded:
    def test_a_short_record_stays_as_it_is(self):
        record = {"type": "alarm", "t": 0.5, "value": [1.0, 2.0], "unit": None}
        assert bounded(record) == record

    def test_texts_are_cut_and_the_rest_is_counted(self):
        assert bounded(log(1, "a" * 4007)) == log(1, "a" * 4000) | {"cut": 7}

    def test_texts_within_values_count_too(self):
        found = bounded({"type": "alarm", "t": 0.0, "hints": ["b" * 5000, "c" * 4001]})
        assert found["cut"] == 1001
        assert [len(hint) for hint in found["hints"]] == [4000, 4000]

    def test_deep_long_and_wide_values_end(self):
        deep: list[object] = []
        for _ in range(100_000):
            deep = [deep]
        found = bounded({"type": "alarm", "t": 0.0, "value": [deep, [1] * 10**6, {str(n): n for n in range(10**4)}]})
        assert size_of(found) < 20_000

    def test_names(self):
        assert cut_name("n" * 200) == "n" * 200
        assert cut_name("n" * 201) == "n" * 200 + "…"


class TestBudget:
    def test_events_up_to_the_number_and_then_the_last(self, monkeypatch):
        monkeypatch.setattr(limits, "LAST_EVENTS", 2)
        budget = EventBudget(3)
        assert budget.take(map(log, range(10))) == [log(0), log(1), log(2)]
        assert (budget.events, budget.from_s) == (7, 3.0)
        assert budget.last() == [log(8), log(9)]
        assert (budget.events, budget.from_s) == (5, 3.0)
        assert budget.last() == []

    def test_events_up_to_the_bytes(self, monkeypatch):
        monkeypatch.setattr(limits, "BYTES_MAX", 1000)
        monkeypatch.setattr(limits, "LAST_EVENTS", 1)
        monkeypatch.setattr(limits, "LAST_BYTES", 300)
        budget = EventBudget()
        # 64 for the record, 1 + 8 for `t`, 4 + 3 for `type`, 4 + 100 for `text`: five of 184 are 920.
        assert size_of(log(0, "d" * 100)) == 184
        assert len(budget.take([log(n, "d" * 100) for n in range(8)])) == 5
        assert (budget.events, budget.bytes) == (3, 3 * 184)
        assert budget.last() == [log(7, "d" * 100)]
        assert (budget.events, budget.bytes) == (2, 2 * 184)

    def test_no_alarm_is_left_out_and_times_ascend(self, monkeypatch):
        monkeypatch.setattr(limits, "LAST_EVENTS", 1)
        budget = EventBudget(1)
        alarm = {"type": "alarm", "t": 2.0, "text": ""}
        assert budget.take([log(0), log(1), alarm, log(3), log(4)]) == [log(0)]
        assert budget.last() == [alarm, log(4)]
        assert budget.events == 2

    def test_what_was_cut_of_texts_that_are_given_counts(self):
        budget = EventBudget()
        assert budget.take([log(0, "e" * 5000)]) == [log(0, "e" * 4000) | {"cut": 1000}]
        assert (budget.events, budget.bytes) == (0, 1000)

    def test_a_million_long_texts_take_no_memory(self):
        budget = EventBudget()
        text = "f" * 3000
        given = sum(size_of(record) for n in range(10_000) for record in budget.take([log(n, text)]))
        assert given <= limits.BYTES_MAX
        assert sum(map(size_of, budget.last())) <= limits.LAST_BYTES


@pytest.mark.parametrize("most", [limits.EVENTS_MAX, limits.LAST_EVENTS])
def test_the_page_names_the_limits(most):
    text = (Path(__file__).parents[2] / "web" / "src" / "text" / "en.ts").read_text(encoding="utf-8")
    assert f"{most:,}" in text.split("messages_left_out", 1)[1].splitlines()[0]
