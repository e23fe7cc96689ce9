"""The page as a file: alone in the world, small, and true to its data."""

import json
import re
from dataclasses import replace

import pytest

from elitescript import PlantConfig
from elitescript.messages.events import ChannelActivity, SignalChanged
from elitescript.plotting.line_times import LineStretch
from elitescript.plotting.packing import undo_deltas
from elitescript.plotting.plain_page import SOURCE_MAX, page_data
from elitescript.plotting.plain_page import plain_page as page
from tests.plotting.recordings import PROGRAM, of_rows, recorded, restless, row


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
    (output,) = data["signals"]["lanes"]
    assert (output["name"], output["v"]) == ("standard_digital_out[2]", [1, 0])
    assert len(data["joints"]) == 6


def test_the_whole_program_is_on_the_page():
    data = embedded(page(recorded()))
    assert [data["source"][str(number)] for number in range(1, 9)] == PROGRAM.splitlines()
    assert (len(data["source"]), data["source_lines"]) == (8, 8)


def test_a_very_long_program_keeps_its_begin_and_every_line_that_is_named():
    program = "def job():\n" + "  x = 1\n" * 20_000 + "  sleep(1)\nend\n"
    data = embedded(page(recorded(program)))
    assert {"1", "5000", "20002"} <= data["source"].keys()
    assert "20001" not in data["source"]
    assert data["source_lines"] == 20_003
    assert sum(map(len, data["source"].values())) < SOURCE_MAX


def test_what_hides_in_a_text_is_written_out():
    data = embedded(page(recorded("def job():\n  textmsg('a\u202eb')  # \u2066c\nend\n")))
    assert data["marks"][0]["text"] == "a\\u202eb"
    assert data["source"]["2"] == "  textmsg('a\\u202eb')  # \\u2066c"


def test_the_lines_of_other_threads_are_on_the_page():
    spans = {"camera": [LineStretch(0.1, 0.5, 4), LineStretch(0.5, 0.9, 6)], "never": []}
    (thread,) = page_data(replace(recorded(), thread_lines=spans))["threads"]
    assert (thread["name"], undo_deltas(thread["t"]), thread["line"]) == ("camera", [100, 500, 900], [4, 6])


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


def test_a_page_with_everything_at_its_bound_stays_below_a_megabyte():
    names = [f"output_int_register[{index}]" for index in range(48)] + [f"flag[{index}]" for index in range(32)]
    events = [SignalChanged(tick, name, tick % 2) for tick in range(1, 500) for name in names]
    events += [ChannelActivity(k, f"c{k % 50}", "socket", "sent", f"{k}" * 50) for k in range(20_000)]
    recording = replace(recorded(), events=sorted(events, key=lambda event: event.tick))
    assert len(page(recording).encode()) < 1_000_000
