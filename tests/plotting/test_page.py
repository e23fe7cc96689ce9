"""The page as a file: alone in the world, small, and true to its data."""

import json
import re

import pytest

from elitescript import PlantConfig
from elitescript.plotting.page import page, page_data
from tests.plotting.recordings import of_rows, recorded, restless, row


def embedded(text):
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)[1])


def test_the_page_asks_no_other_computer_for_anything():
    text = page(recorded())
    assert re.findall(r"https?://", text.replace("http://www.w3.org/2000/svg", "")) == []
    assert re.findall(r'(?:src|href)="(?!data:)|@import|url\(|fetch\(|XMLHttpRequest|WebSocket|import\(', text) == []
    assert "default-src 'none'" in text


def test_no_text_of_a_program_ends_its_script_element():
    text = page(recorded())
    assert text.count("</script>") == 2
    assert embedded(text)["marks"][0]["text"] == "</script><b>done</b>"


def test_a_title_is_text():
    recording = of_rows([row(0.0), row(0.004)])
    text = page(type(recording)("<b>&@@data@@.csv", recording.model, recording.rows))
    assert "<title>&lt;b&gt;&amp;@@data@@.csv" in text


def test_no_place_of_the_template_is_left_empty():
    assert "@@" not in page(recorded())


def test_the_data_say_what_happened():
    data = embedded(page(recorded()))
    assert (data["model"], data["state"], data["start"]) == ("CS66", "finished", 0.0)
    assert sum(moving + standing for _, moving, standing, _ in data["table"]) == pytest.approx(data["end"])
    assert [move[2:] for move in data["moves"]] == [["movej", 3], ["movel", 7]]
    assert data["source"]["4"] == "sleep(0.5)"
    (output,) = data["signals"]
    assert (output["name"], output["v"]) == ("standard_digital_out[2]", [1, 0])
    assert len(data["joints"]) == 6


def test_the_spans_cover_the_time_without_a_gap():
    spans = page_data(recorded())["spans"]
    assert len(spans["t"]) == len(spans["line"]) + 1
    assert min(spans["t"][1:]) > 0


@pytest.mark.parametrize("rows", [[row(0.0)], [row(0.0), row(0.004)]], ids=["one row", "two rows"])
def test_a_trace_of_nothing_is_a_page(rows):
    assert embedded(page(of_rows(rows)))["end"] == rows[-1].t


def test_two_restless_minutes_stay_small():
    assert len(page(of_rows(restless(30_000))).encode()) < 400_000


def test_the_same_recording_gives_the_same_bytes():
    assert page(recorded()) == page(recorded())


def test_a_tracking_error_is_shown_where_there_is_one():
    assert embedded(page(recorded()))["errors"] == []
    assert len(embedded(page(recorded(plant=PlantConfig(lag_s=0.01))))["errors"]) == 6
