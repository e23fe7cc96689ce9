"""The data of the page of a sweep, unpacked by hand; how it looks is tested in a browser."""

from __future__ import annotations

import gzip
import json
import math
import struct
from array import array
from base64 import b64decode

from elitescript.sweep.plans.plan import Disturbance, Plan
from elitescript.sweep.results.page import LABELS_MAX, PageTexts, Replay, packed, sweep_page
from elitescript.sweep.results.summary import summary_of
from tests.plotting.front_end import pretend_built
from tests.sweep.made import BOX, row, swept


def unpacked(data):
    data = gzip.decompress(data)
    (size,) = struct.unpack_from("<I", data)
    head = json.loads(data[4 : 4 + size])
    columns, offset = {}, 4 + size
    for column in head["columns"]:
        code = {"i32": "i", "i16": "h", "f32": "f"}[column["type"]]
        values = array(code)
        width = values.itemsize * head["rows"]
        values.frombytes(data[offset : offset + width])
        columns[column["role"], column["name"]] = (
            [column["labels"][value] for value in values] if "labels" in column else list(values)
        )
        offset += width
    assert offset == len(data)
    return head, columns


def test_every_row_is_there_in_the_order_of_runs():
    drawn = []

    def made(run, v, _):
        drawn.append(v)
        drop = (Disturbance("drop", "gripper", 3.2), Disturbance("pause", at_s=4.0)) if run == 7 else ()
        return row(
            run, v, "always(ok)" if run in (7, 9) else "", 10.0 + run, drop, (0.5 if run else None,),
            line=4 * (run == 9),
            measures={"peak": 1e300 if run == 1 else None if run == 2 else 2.0, "held": run % 2 == 0},
        )  # fmt: skip

    totals = swept(20, made, measures=("peak", "held"))
    texts = PageTexts(
        "cell </script>",
        stories={7: ["The answer was lost."]},
        replays={7: Replay("page.replays/run-7.html")},
        smallest={7: Replay("page.replays/run-7-smallest.html", "elitescript run --case CASE.toml")},
    )
    head, columns = unpacked(packed(Plan("", variations=BOX), totals, summary_of(totals), texts))
    assert columns["run", "run"] == list(range(20))
    assert columns["kind", "kind"] == [-1] * 7 + [0, -1, 1] + [-1] * 10
    assert columns["time", "time_s"] == [10.0 + run for run in range(20)]
    assert columns["varied", "part_x"] == list(array("f", [v["part_x"] for v in drawn]))
    assert columns["varied", "speed"] == [v["speed"] for v in drawn]
    peak = columns["measure", "peak"]
    assert (peak[0], peak[1]) == (2.0, math.inf) and math.isnan(peak[2])
    assert columns["measure", "held"] == ["true", "false"] * 10
    assert math.isnan(columns["margin", "always(ok)"][0])
    assert columns["disturbances", "disturbances"][7] == "drop on gripper, pause"
    assert [kind["count"] for kind in head["kinds"]] == [1, 1]
    first = head["kinds"][0]
    assert first["story"] == ["The answer was lost."]
    assert first["smallest"] == {
        "page": "page.replays/run-7-smallest.html",
        "command": "elitescript run --case CASE.toml",
    }
    assert first["runs"] == [
        {
            "run": 7,
            "page": "page.replays/run-7.html",
            "disturbances": ["3.200 s: drop on gripper", "4.000 s: pause"],
        }
    ]
    assert [entry["run"] for entry in head["nearest"]] == [1]


def test_many_texts_and_kinds_are_cut_and_said():
    totals = swept(
        1500, lambda run, v, _: row(run, v, "always(ok)", line=run, measures={"id": f"n{run}"}), measures=("id",)
    )
    head, columns = unpacked(packed(Plan("", variations=BOX), totals, summary_of(totals), PageTexts("t")))
    assert len(set(columns["measure", "id"])) == LABELS_MAX + 1
    assert columns["measure", "id"].count("(others)") == 1500 - LABELS_MAX
    assert len(head["kinds"]) == 100 and head["kinds_left_out"] == 401
    assert max(columns["kind", "kind"]) == 500


def test_a_sample_says_what_it_is_of():
    totals = swept(3000, lambda run, v, _: row(run, v, "always(ok)" if run % 100 == 0 else ""), sample=500)
    head, columns = unpacked(packed(Plan("", variations=BOX), totals, summary_of(totals), PageTexts("t")))
    assert head["failing"] == [30, 1]
    shown, one_in = head["holding"]
    assert one_in == 8 and shown + 30 == head["rows"] == len(columns["run", "run"])


def test_texts_of_programs_are_no_markup(tmp_path, monkeypatch):
    pretend_built(tmp_path, monkeypatch)
    evil = "</script><img src=x onerror=alert(1)>\u202e\ud800"
    totals = swept(3, lambda run, v, _: row(run, v, evil, text=evil))
    texts = PageTexts(evil, command=evil, stories={0: [evil]})
    page = sweep_page(Plan("", variations=BOX), totals, summary_of(totals), texts)
    assert "<img" not in page
    assert page.count("<title>") == 1
    data = page.split('id="recording">')[1].split("<")[0]
    head, _ = unpacked(b64decode(data))
    assert head["kinds"][0]["story"][0].startswith("</script><img")
