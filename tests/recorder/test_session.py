"""Sessions with a small controller on loopback: what is sent to it, what is heard, and what survives."""

from __future__ import annotations

import asyncio
import errno
import struct
import time

import pytest

from elitescript.client import rtsi
from elitescript.errors import UsageError
from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.recorder.channels import CHANGES, DASHBOARD, EVENTS, GROUPS, PRIMARY, SLOW
from elitescript.recorder.mcap_file import files_of, read_recording
from elitescript.recorder.session import PORTS, Session, Target
from elitescript.recorder.sinks import StorageError
from elitescript.recorder.storing import McapSink, Rotation
from elitescript.recorder.writing import RecordingFile
from tests.protocol.rtsi_client import message
from tests.recorder.controller import HOST, FakeController, closed_port, served, ticks


class Heard:
    """A sink that keeps everything."""

    def __init__(self) -> None:
        self.rows: list[float] = []
        self.messages: list[tuple[str, dict]] = []
        self.layouts = []

    def begin_rows(self, layout) -> None:
        self.layouts.append(layout)

    def row(self, t, flat, arrived_ns) -> None:
        self.rows.append(t)

    def message(self, channel, data, arrived_ns) -> None:
        self.messages.append((channel, dict(data)))

    def tick(self, now_ns) -> None:
        pass

    def of(self, channel: str, kind: str = "") -> list[dict]:
        return [data for name, data in self.messages if name == channel and kind in ("", data.get("type"))]


def record(controller: FakeController, sinks, rows: int, *ports: str, also=lambda: True) -> tuple[Session, list[str]]:
    """Run a session until so many rows have come."""
    sinks = sinks if isinstance(sinks, list) else [sinks]
    said: list[str] = []
    sessions: list[Session] = []

    async def test() -> None:
        async with served(controller, *ports) as target:
            session = Session(target, sinks, said.append)
            sessions.append(session)

            async def enough() -> None:
                while session.pace.rows < rows or not also():
                    await asyncio.sleep(0.002)

            await session.run(enough())

    asyncio.run(asyncio.wait_for(test(), 20.0))
    return sessions[0], said


def frames(data: bytes) -> list[tuple[str, bytes]]:
    found = []
    while data:
        size, letter = struct.unpack_from(">HB", data)
        found.append((chr(letter), bytes(data[3:size])))
        data = data[size:]
    return found


def test_nothing_is_sent_but_questions_and_output_recipes():
    controller = FakeController(ticks(1.0, 50))
    heard = Heard()
    record(controller, heard, 50, also=lambda: len(heard.of(DASHBOARD)) >= 10)
    assert controller.got["primary"] == b""
    assert controller.got["dashboard"].decode().splitlines() == [
        "echo",
        "version",
        "robot -t",
        "robot -s",
        "robot -id",
        "task",
        "task -s",
        "robotMode",
        "safety -m",
        "speed",
        "remoteControl -s",
    ]
    asked = frames(bytes(controller.got["rtsi"]))
    assert [letter for letter, _ in asked] == ["V", "v", "O", "O", "O", "S"]
    assert [body for letter, body in asked if letter in "VvS"] == [b"\0\1", b"", b""]
    recipes = [
        (struct.unpack(">d", body[:8])[0], body[8:].decode().split(",")) for letter, body in asked if letter == "O"
    ]
    assert [hz for hz, _ in recipes] == [250.0, 10.0, 250.0]
    assert all(names[0] == "timestamp" for _, names in recipes)
    assert sorted({name for _, names in recipes for name in names}) == sorted(OUTPUTS)


def test_every_variable_of_rtsi_is_asked_for_once():
    asked = [name for group in GROUPS for name in group.variables if name != "timestamp"]
    assert sorted([*asked, "timestamp"]) == sorted(OUTPUTS)


def test_what_the_ports_say_reaches_the_sinks():
    controller = FakeController(
        ticks(1.0, 51), values=lambda t: {"output_int_register3": int(t > 1.1), "payload_mass": 1.5}
    )
    heard = Heard()
    session, said = record(controller, heard, 51, also=lambda: session_is_told(heard))
    assert heard.rows == ticks(1.0, 51)
    first, second = heard.of(CHANGES)
    assert (first["timestamp"], first["payload_mass"], first["output_int_register3"]) == (1.0, 1.5, 0)
    assert second == {"timestamp": 1.104, "output_int_register3": 1}
    assert [values["timestamp"] for values in heard.of(SLOW)] == [1.0, 1.1, 1.2]
    assert heard.of(PRIMARY) == [{"type": "text", "source": 104, "timestamp": 1_000_000, "text": "hello"}]
    assert {"type": "answer", "question": "robot -t", "answer": "CS66"} in heard.of(DASHBOARD)
    assert session.task == "cells/pick.task"
    connected = next(data for data in heard.of(EVENTS, "connected") if data["port"] == "rtsi")
    assert connected["version"] == "2.14.0.1"
    assert connected["missing"] == []
    number = session.target.ports["dashboard"]
    assert said == [f"CS66, serial ES1234, id 7, at {HOST}, dashboard {number}; task: cells/pick.task"]


def session_is_told(heard: Heard) -> bool:
    return len(heard.of(DASHBOARD)) >= 10 and bool(heard.of(PRIMARY))


def test_nobody_at_the_address_leaves_nothing_behind(tmp_path):
    port = closed_port()
    sink = McapSink(tmp_path / "run.mcap", {})
    target = Target(HOST, dict.fromkeys(("rtsi", "primary", "dashboard"), port), backoff_s=(0.01,))

    async def test() -> None:
        await Session(target, [sink], print).run(asyncio.sleep(5.0))

    with pytest.raises(UsageError, match=f"nothing answers at {HOST}: .*RTSI port {HOST}:{port}: "):
        asyncio.run(test())
    sink.close()
    assert list(tmp_path.iterdir()) == []


def test_a_port_that_is_not_there_is_said_and_the_others_are_heard():
    heard = Heard()
    _, said = record(FakeController(ticks(1.0, 30)), heard, 30, "rtsi")
    assert sorted(text.partition(":")[0] for text in said) == ["dashboard", "primary"]
    assert all("lost, trying again" in text for text in said)
    assert sorted(data["port"] for data in heard.of(EVENTS, "lost")) == ["dashboard", "primary"]


def test_a_lost_connection_is_taken_up_again_and_the_gap_is_counted():
    controller = FakeController(ticks(1.0, 100), ticks(2.0, 100))
    heard = Heard()
    session, said = record(controller, heard, 200)
    assert heard.rows == ticks(1.0, 100) + ticks(2.0, 100)
    assert (session.pace.gaps, session.pace.missing, session.pace.restarts) == (1, 150, 0)
    (gap,) = heard.of(EVENTS, "gap")
    assert gap == {"type": "gap", "begin_s": 1.396, "end_s": 2.0, "missing": 150}
    assert [data["port"] for data in heard.of(EVENTS, "lost")] == ["rtsi"]
    assert any("rtsi: lost, trying again (RTSI" in text for text in said)
    assert any(text.startswith("rtsi: connected, after 0.") for text in said)
    assert "150 rows are missing between 1.396 s and 2.000 s of the controller" in said


@pytest.mark.parametrize("before", [10, 60])
def test_rows_that_are_repeated_are_counted_apart_and_not_stored(tmp_path, before):
    """As a served robot sends while a call of its program hangs: then what it makes up for, nothing left out."""
    times = ticks(1.0, before)
    again = [times[-1]] * 75
    controller = FakeController([*times, *again, *ticks(times[-1] + 0.004, 40)], asks_first=True)
    path = tmp_path / "run.mcap"
    heard, sink = Heard(), McapSink(path, {})
    session, said = record(controller, [heard, sink], before + 40)
    sink.close()
    assert heard.rows == ticks(1.0, before + 40)
    pace = session.pace
    assert (pace.rows, pace.repeated, pace.gaps, pace.restarts) == (before + 40, 75, 0, 0)
    assert heard.of(EVENTS, "repeated") == [{"type": "repeated", "t": times[-1]}]
    stamps = [values["timestamp"] for values in heard.of(SLOW)]
    assert stamps == sorted(set(stamps))
    found = read_recording(path)
    assert list(found.t) == ticks(1.0, before + 40)
    assert (found.gaps, found.restarts, found.rate_hz) == ((), (), 250.0)
    assert [said.data["t"] for said in found.messages if said.data["type"] == "repeated"] == [times[-1]]
    # The dashboard names the robot whenever it has answered.
    assert [text for text in said if "CS66" not in text] == []


def test_a_controller_that_was_started_anew():
    heard = Heard()
    session, said = record(FakeController(ticks(50.0, 40), ticks(0.5, 40)), heard, 80)
    assert (session.pace.gaps, session.pace.restarts) == (0, 1)
    assert heard.of(EVENTS, "restart") == [{"type": "restart", "before_s": 50.156, "after_s": 0.5}]
    assert "the controller's time began anew: 0.500 s after 50.156 s" in said


def test_a_connection_that_falls_silent_is_given_up(monkeypatch):
    monkeypatch.setattr(rtsi.RtsiClient.packages, "__defaults__", (0.05,))
    heard = Heard()
    controller = FakeController(ticks(1.0, 30), ticks(1.2, 30), closes=False)
    _, said = record(controller, heard, 60)
    assert heard.rows == ticks(1.0, 30) + ticks(1.2, 30)
    assert any("RTSI, packages: nothing came in time" in text for text in said)


@pytest.mark.parametrize(
    ("garbage", "text"),
    [
        (b"\0\1U", "a message says that it has 1 bytes"),
        (message("U", b"\x03short"), "a package of recipe 3 has 6 bytes"),
    ],
)
def test_garbage_ends_a_connection_and_no_more(garbage, text):
    heard = Heard()
    controller = FakeController(ticks(1.0, 30), ticks(1.12, 30), closes=False, after=garbage + bytes(8))
    _, said = record(controller, heard, 60)
    assert heard.rows == ticks(1.0, 60)
    assert any(text in line for line in said)


@pytest.mark.parametrize("time", [float("nan"), float("inf"), -1e300])
def test_a_row_without_a_time_ends_a_connection_and_no_more(time, tmp_path):
    sink = McapSink(tmp_path / "run.mcap", {"host": HOST})
    controller = FakeController([*ticks(1.0, 30), time], ticks(1.12, 30), closes=False)
    _, said = record(controller, sink, 60)
    sink.close()
    assert list(read_recording(sink.path).t) == ticks(1.0, 60)
    assert any("a row has the timestamp" in line for line in said)


def test_a_name_that_no_computer_can_have_is_nobody():
    async def test() -> None:
        for host in ("a..b", "x" * 300, "\udcff"):
            with pytest.raises(UsageError, match=r"nothing answers at .*no name of a computer"):
                await Session(Target(host, dict.fromkeys(PORTS, 1)), [Heard()], print).run(asyncio.Event().wait())

    asyncio.run(test())


def test_garbage_at_the_other_ports_does_not_touch_the_rows():
    heard = Heard()
    controller = FakeController(ticks(1.0, 30), primary=b"\xff" * 64)
    record(controller, heard, 30, also=lambda: bool(heard.of(EVENTS, "lost")))
    assert heard.rows == ticks(1.0, 30)
    assert "a message says that it has 4294967295 bytes" in heard.of(EVENTS, "lost")[0]["why"]


def test_an_older_controller_with_fewer_variables():
    has = {"timestamp", "actual_joint_positions", "robot_mode"}
    heard = Heard()
    record(FakeController(ticks(1.0, 30), missing=set(OUTPUTS) - has), heard, 30)
    assert heard.layouts[0].names == ("timestamp", "robot_mode", "actual_joint_positions")
    connected = next(data for data in heard.of(EVENTS, "connected") if data["port"] == "rtsi")
    assert connected["missing"] == sorted(set(OUTPUTS) - has)


def test_a_controller_without_time_is_not_recorded():
    heard = Heard()
    controller = FakeController(ticks(1.0, 5), missing=["timestamp"])
    record(controller, heard, 0, also=lambda: bool(heard.of(EVENTS, "lost")))
    assert heard.of(EVENTS, "lost")[0]["why"].endswith(": the controller has no timestamp")
    assert heard.rows == []


def test_a_controller_that_hangs_up_at_a_further_recipe_gets_one_less():
    heard = Heard()
    controller = FakeController(ticks(1.0, 30), recipes_max=1)
    _, said = record(controller, heard, 30)
    assert heard.rows == ticks(1.0, 30)
    assert heard.of(CHANGES) == heard.of(SLOW) == []
    assert controller.opened["rtsi"] == 5
    assert [text.split(":")[1] for text in said if "without" in text] == [
        " going on without /slow",
        " going on without /changes",
    ]


class ByRows(McapSink):
    """Has its ticks after rows, not after seconds."""

    every = 400

    def row(self, t, flat, arrived_ns):
        super().row(t, flat, arrived_ns)
        if self.rows % self.every == 0:
            super().tick(arrived_ns)

    def tick(self, now_ns):
        pass


class TestStoring:
    def test_the_files_of_a_rotation_are_one_recording_and_each_opens_alone(self, tmp_path):
        path = tmp_path / "run.mcap"
        sink = ByRows(path, {"host": HOST}, {"cell.script": b"x = 1\n"}, Rotation(size=1))
        times = ticks(1.0, 1000)
        controller = FakeController(
            times,
            values=lambda t: {"output_int_register3": 5 + int(t > 4.0), "actual_joint_positions": (t,) * 6},
            asks_first=True,
        )
        record(controller, sink, 1000)
        assert sink.files == 3
        sink.close()
        assert files_of(path) == [path, tmp_path / "run.0001.mcap", tmp_path / "run.0002.mcap"]
        whole = read_recording(path)
        assert list(whole.t) == times
        assert list(whole.columns["actual_joint_positions.3"]) == times
        assert list(whole.columns["output_int_register3"]) == [5 + int(t > 4.0) for t in times]
        assert whole.facts["model"] == "CS66"
        models = [said for said in whole.messages if said.data.get("question") == "robot -t"]
        assert len(models) == 1
        assert whole.arrived_s[0] >= 0.0
        assert list(whole.arrived_s) == sorted(whole.arrived_s)
        (tmp_path / "run.0003.mcap").write_bytes(b"")
        assert len(read_recording(path).t) == 1000
        last = read_recording(tmp_path / "run.0002.mcap")
        assert list(last.t) == times[800:]
        assert set(last.columns["output_int_register3"]) == {6.0}
        assert last.facts["model"] == "CS66"
        assert last.attachments == {"cell.script": b"x = 1\n"}

    def test_the_metadata_says_version_recipes_and_clock(self, tmp_path):
        from mcap.reader import make_reader

        path = tmp_path / "run.mcap"
        sink = ByRows(path, {"host": "robot.local"})
        record(FakeController(ticks(1.0, 30), missing=set(OUTPUTS) - {"timestamp", "robot_mode"}), sink, 30)
        sink.close()
        with path.open("rb") as file:
            found = {item.name: item.metadata for item in make_reader(file).iter_metadata()}
        assert found["elitescript"]["host"] == "robot.local"
        assert found["controller"] == {"version": "2.14.0.1", "/rows": "timestamp,robot_mode"}
        offset_s = float(found["clock"]["offset_s"])
        assert offset_s == pytest.approx(read_recording(path).facts["clock_offset_s"], abs=1e-5)
        assert abs(offset_s - time.time()) < 60.0

    def test_places_that_are_no_numbers_are_not_shown_to_viewers(self, tmp_path):
        sink = McapSink(tmp_path / "run.mcap", {"host": HOST})
        values = {"actual_TCP_pose": (float("nan"), 0.0, 0.0, float("inf"), 0.0, 0.0)}
        record(FakeController(ticks(1.0, 30), values=lambda _: values), sink, 30)
        sink.close()
        recording = read_recording(sink.path)
        assert len(recording.t) == 30
        assert recording.columns["actual_TCP_pose.3"][-1] == float("inf")

    def test_files_that_are_there_are_not_touched(self, tmp_path):
        later = tmp_path / "run.0001.mcap"
        later.write_bytes(b"mine")
        with pytest.raises(UsageError, match=r"run\.0001\.mcap exists already"):
            McapSink(tmp_path / "run.mcap", {})
        with pytest.raises(UsageError, match="there is no folder"):
            McapSink(tmp_path / "away" / "run.mcap", {})
        assert later.read_bytes() == b"mine"

    def test_a_full_disk_ends_the_session_and_leaves_what_there_is(self, tmp_path, monkeypatch):
        path = tmp_path / "run.mcap"
        sink = ByRows(path, {})
        plain = RecordingFile.row

        def row(self, numbers, arrived_ns, time_ns):
            if sink.rows == 600:
                raise OSError(errno.ENOSPC, "No space left on device")
            plain(self, numbers, arrived_ns, time_ns)

        monkeypatch.setattr(RecordingFile, "row", row)
        with pytest.raises(StorageError, match=r"run\.mcap: No space left on device; what was written before"):
            record(FakeController(ticks(1.0, 700)), sink, 700)
        sink.close()
        assert list(tmp_path.iterdir()) == [path]
        assert list(read_recording(path).t) == ticks(1.0, 400)

    def test_a_new_firmware_after_a_lost_connection_has_other_columns(self, tmp_path):
        path = tmp_path / "run.mcap"
        sink = McapSink(path, {})
        controller = FakeController(ticks(1.0, 40), ticks(1.16, 40), values=lambda t: {"robot_mode": 7})
        controller.missing = frozenset({"robot_mode"})
        plain = sink.begin_rows

        def begin(layout):
            controller.missing = frozenset()
            plain(layout)

        sink.begin_rows = begin
        record(controller, sink, 80)
        sink.close()
        found = read_recording(path)
        assert list(found.t) == ticks(1.0, 80)
        modes = found.columns["robot_mode"]
        assert all(mode != mode for mode in modes[:40])
        assert set(modes[40:]) == {7.0}
