"""Frames of rows, read by code that was written from the description alone, and by the page's own reader."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from array import array
from pathlib import Path

import pytest

from elitescript.controller.views.trace import Trace, TraceRow
from elitescript.conversation.rows import COLUMNS, FRAME_BYTES_MAX, RowWriter, frames, frames_of
from elitescript.errors import UsageError
from elitescript.robot import VirtualRobot
from tests.conversation.frames import read

ROOT = Path(__file__).parents[2]
READER = ROOT / "web/src/source/rows.ts"


def row(tick, q1, x=0.0, actual=None):
    return TraceRow(tick / 250, 1, (q1, 0, 0, 0, 0, 0.5), (0.25, 0, 0, 0, 0, 0), (x, 0, 1, 0, 0, 0), "playing", actual)


def test_columns_are_those_of_the_page():
    listed = READER.read_text(encoding="utf-8").partition("COLUMNS = [")[2].partition("]")[0]
    assert tuple(re.findall(r'"(\w+)"', listed)) == COLUMNS


class TestFrames:
    def test_equal_steps_are_not_listed(self):
        (frame,) = frames(7, [10, 20, 30], {"q1": [0.0, 0.5, 1.0], "speed": array("d", [1.0, 2.0, 3.0])})
        assert read(frame) == (7, [10, 20, 30], {"q1": [0.0, 0.5, 1.0], "speed": [1.0, 2.0, 3.0]})

    def test_other_steps_are_listed(self):
        (frame,) = frames(7, [10, 20, 21], {"q1": [0.0, 0.5, 1.0]})
        assert read(frame) == (7, [10, 20, 21], {"q1": [0.0, 0.5, 1.0]})

    def test_none_without_rows(self):
        assert list(frames(7, [], {"q1": []})) == []

    def test_many_rows_become_frames_of_limited_size(self):
        ticks = [tick * tick for tick in range(40_000)]
        made = list(frames(1, ticks, {"q1": [float(tick % 1000) for tick in ticks], "fx": [0.0] * len(ticks)}))
        assert max(map(len, made)) <= FRAME_BYTES_MAX < 2 * len(made[0])
        found = [read(frame) for frame in made]
        assert [tick for _, part, _ in found for tick in part] == ticks
        assert [value for _, _, columns in found for value in columns["q1"]] == [float(tick % 1000) for tick in ticks]

    @pytest.mark.parametrize(
        ("columns", "text"), [({"q7": [0.0]}, "'q7' is no column"), ({"q1": [0.0, 1.0]}, "q1 has 2 rows, not 1")]
    )
    def test_refuses_other_columns(self, columns, text):
        with pytest.raises(UsageError, match=text):
            list(frames(1, [0], columns))


class TestRowWriter:
    def test_speed_is_the_mean_since_the_row_before_also_across_frames(self):
        writer = RowWriter(2)
        writer.append(row(0, 0.0, 0.0))
        writer.append(row(10, 0.5, 0.25))
        first = read(writer.take()[0])
        writer.append(row(20, 0.75, 0.5))
        writer.append(row(30, 0.75, 9.0))
        second = read(writer.take()[0])
        assert first[2]["speed"] == [0.0, 6.25]
        # The last one: the joints stand, so another TCP has moved the place.
        assert second[2]["speed"] == [6.25, 0.0]
        assert writer.take() == []

    def test_measured_joints_are_columns_where_they_are_known(self):
        (frame,) = frames_of(1, [row(0, 1.0, actual=(0.5, 0, 0, 0, 0, 0.25))])
        columns = read(frame)[2]
        assert (columns["qa1"], columns["qa6"], columns["q6"]) == ([0.5], [0.25], [0.5])

    def test_spans_give_what_rows_give(self):
        class Written(Trace):
            def _take(self, span):
                writer.add(span)
                super()._take(span)

        writer, rows = RowWriter(4), []
        text = (
            "def p():\n  movej([0, -1.5, 0.3, -1.57, 0, 0])\n  sleep(0.5)\n  movel([0.3, -0.2, 0.5, 3.14, 0, 0])\nend\n"
        )
        run = VirtualRobot("CS66").run(text, trace=Written(rows.append, 0.04))
        assert len(rows) > 30
        _, ticks, columns = read(writer.take()[0])
        assert [tick / 250 for tick in ticks] == [found.t for found in rows]
        for number in range(6):
            assert columns[f"q{number + 1}"] == pytest.approx([found.q[number] for found in rows], abs=2.4e-7)
            assert columns[f"qd{number + 1}"] == pytest.approx([found.qd[number] for found in rows], abs=2.4e-7)
        assert columns["rz"] == pytest.approx([found.tcp_pose[5] for found in rows], abs=2.4e-7)
        assert ticks[-1] == round(run.time_s * 250)


def node_that_reads_typescript():
    """Return the Node.js of `make studio`, or another one that runs TypeScript; None if there is none."""
    for node in (str(ROOT / "build/node/bin/node"), shutil.which("node")):
        if node is not None and Path(node).exists():
            version = subprocess.check_output([node, "-p", "process.versions.node"], text=True)
            if int(version.partition(".")[0]) >= 24:
                return node
    return None


def test_the_page_reads_the_same(tmp_path):
    node = node_that_reads_typescript()
    if node is None:
        pytest.skip("there is no Node.js 24 here")
    (frame,) = frames_of(9, [row(3, 0.125), row(7, 0.25, 0.5), row(8, 0.5, 0.75)])
    (tmp_path / "frame").write_bytes(frame)
    (tmp_path / "rows.mts").write_text(READER.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "read.mts").write_text(
        'import { readFileSync } from "node:fs";\n'
        'import { readRows } from "./rows.mts";\n'
        "const bytes = readFileSync(process.argv[2]!);\n"
        "const rows = readRows(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));\n"
        "const columns = Object.fromEntries([...rows.columns].map(([name, values]) => [name, Array.from(values)]));\n"
        "console.log(JSON.stringify([rows.run, Array.from(rows.ticks), columns]));\n"
    )
    printed = subprocess.run(
        [node, str(tmp_path / "read.mts"), str(tmp_path / "frame")], capture_output=True, text=True, check=True
    )
    run, ticks, columns = json.loads(printed.stdout)
    assert columns.pop("tick") == ticks
    assert (run, ticks, columns) == read(frame)
