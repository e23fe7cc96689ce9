"""Recordings written to MCAP and read again: by our reader, by the library's, and what is refused."""

from __future__ import annotations

import json
from array import array
from math import isnan, nan

import pytest

from elitescript.errors import UsageError
from elitescript.recorder.mcap_file import read_recording
from elitescript.recorder.recording import Message, Recording
from elitescript.recorder.writing import RecordingFile, write_recording

BEGIN_NS = 1_700_000_000_000_000_000


def recording(count: int = 1200, **changes) -> Recording:
    t = array("d", (5.0 + 0.004 * index for index in range(count)))
    settings = {
        "t": t,
        "arrived_s": array("d", (round(0.001 + 0.004 * index, 9) for index in range(count))),
        "columns": {
            "timestamp": t,
            "runtime_state": array("d", (float(index // 400) for index in range(count))),
            **{
                f"actual_joint_positions.{joint}": array("d", (joint + 1e-3 * index for index in range(count)))
                for joint in range(6)
            },
        },
        "rate_hz": 250.0,
        "messages": (
            Message(5.0, 0.0, "events", {"type": "connected", "port": "rtsi", "version": "2.14.0.1"}),
            Message(t[99], 0.4, "dashboard", {"type": "answer", "question": "robot -t", "answer": "CS66"}),
        ),
        "facts": {"host": "192.168.1.20", "model": "CS66", "version": "2.14.0.1", "begin_ns": BEGIN_NS},
        "attachments": {"cell.script": b"movej([0,0,0,0,0,0])\n"},
    }
    return Recording(**{**settings, **changes})


def same(first, second) -> bool:
    """Whether two columns agree; times of arrival are kept as whole nanoseconds since 1970."""
    return len(first) == len(second) and all(
        abs(a - b) < 1e-8 or (isnan(a) and isnan(b)) for a, b in zip(first, second, strict=True)
    )


def test_what_is_written_is_read(tmp_path):
    wanted = recording()
    write_recording(tmp_path / "run.mcap", wanted)
    found = read_recording(tmp_path / "run.mcap")
    assert found.t == wanted.t
    assert same(found.arrived_s, wanted.arrived_s)
    assert found.columns == wanted.columns
    assert found.rate_hz == 250.0
    assert (found.gaps, found.restarts) == ((), ())
    assert [(said.t, said.channel, said.data) for said in found.messages] == [
        (said.t, said.channel, said.data) for said in wanted.messages
    ]
    assert found.facts == wanted.facts
    assert found.attachments == wanted.attachments


def test_chosen_columns_are_read_alone(tmp_path):
    wanted = recording()
    write_recording(tmp_path / "run.mcap", wanted)
    found = read_recording(tmp_path / "run.mcap", columns=["actual_joint_positions.2", "runtime_state", "robot_mode"])
    assert list(found.columns) == ["runtime_state", "actual_joint_positions.2"]
    assert found.columns["actual_joint_positions.2"] == wanted.columns["actual_joint_positions.2"]
    assert found.t == wanted.t
    with pytest.raises(UsageError, match=r"no column 'actual_joint_position'; did you mean 'actual_joint_positions'\?"):
        read_recording(tmp_path / "run.mcap", columns=["actual_joint_position"])


def test_gaps_and_restarts_are_those_of_the_controllers_time(tmp_path):
    t = array("d", (1.0, 1.004, 1.008, 1.02, 1.024, 0.5, 0.504, 0.508))
    arrived = array("d", (0.1 * index for index in range(8)))
    write_recording(tmp_path / "run.mcap", recording(t=t, arrived_s=arrived, columns={"timestamp": t}, messages=()))
    found = read_recording(tmp_path / "run.mcap")
    assert found.gaps == ((1.008, 1.02),)
    assert found.restarts == (5,)


def test_changed_values_hold_from_the_tick_of_their_change(tmp_path):
    from elitescript.recorder.channels import CHANGES
    from elitescript.recorder.protobuf import DOUBLE, RowField, RowLayout

    file = RecordingFile(tmp_path / "run.mcap", {"begin_ns": str(BEGIN_NS)})
    file.begin_rows(RowLayout([RowField("timestamp", DOUBLE)]))

    def row(t):
        file.row((t,), BEGIN_NS, round(t * 1e9))

    def change(t, **values):
        file.message(CHANGES, {"timestamp": t, **values}, BEGIN_NS, 0)

    row(1.0)
    change(1.0, output_int_register0=7, payload_cog=[0.0, 0.0, 0.25], output_int_register1=0)
    row(1.004)
    row(1.008)
    row(1.012)
    change(1.008, output_int_register0=8)
    row(1.016)
    change(1.02, output_int_register0=9, tool_analog_output=None)
    row(1.02)
    file.close()
    found = read_recording(tmp_path / "run.mcap").columns
    assert list(found["output_int_register0"]) == [7, 7, 8, 8, 8, 9]
    assert list(found["payload_cog.2"]) == [0.25] * 6
    assert "output_int_register1" not in found
    assert "payload_cog.0" not in found
    assert same(found["tool_analog_output"], [nan] * 6)
    asked = read_recording(tmp_path / "run.mcap", columns=["output_int_register1"]).columns
    assert list(asked["output_int_register1"]) == [0] * 6


@pytest.mark.parametrize("left", [1, 30, 500])
def test_a_torn_file_is_read_up_to_its_last_whole_chunk(tmp_path, left):
    wanted = recording()
    path = tmp_path / "run.mcap"
    file = RecordingFile(path, {"begin_ns": str(BEGIN_NS)})
    from elitescript.recorder.protobuf import DOUBLE, RowField, RowLayout

    file.begin_rows(RowLayout([RowField("timestamp", DOUBLE)]))
    for index, t in enumerate(wanted.t):
        file.row((t,), BEGIN_NS, round(t * 1e9))
        if index in (500, 999):
            file.flush()
            size = file.size
    file.flush()
    file.abandon()
    data = path.read_bytes()
    path.write_bytes(data[: size + left])
    assert read_recording(path).t == wanted.t[:1000]
    path.write_bytes(data[:size] + bytes(4096))
    assert read_recording(path).t == wanted.t[:1000]


def test_damage_in_front_of_the_end_is_named_with_its_place(tmp_path):
    path = tmp_path / "run.mcap"
    write_recording(path, recording())
    data = bytearray(path.read_bytes())
    place = data.index(b"zstd") + 500
    data[place : place + 4] = b"\0\0\0\0"
    path.write_bytes(data)
    with pytest.raises(UsageError, match=r"run.mcap: the chunk at byte [\d,]+ is damaged"):
        read_recording(path)


def test_what_is_no_recording_is_refused_in_words(tmp_path):
    from mcap.writer import Writer

    path = tmp_path / "other.mcap"
    with pytest.raises(UsageError, match="No such file"):
        read_recording(path)
    with pytest.raises(UsageError, match="is a folder, not a file"):
        read_recording(tmp_path)
    path.write_bytes(b"")
    with pytest.raises(UsageError, match=r"other\.mcap is empty"):
        read_recording(path)
    path.write_bytes(b"PK\x03\x04 something else")
    with pytest.raises(UsageError, match=r"other\.mcap is no MCAP file"):
        read_recording(path)
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/camera", "json", writer.register_schema("Picture", "jsonschema", b"{}"))
        writer.add_message(channel, 1, b"{}", 1)
        writer.finish()
    with pytest.raises(UsageError, match=r"no recording of a controller: no channel /rows \(channels: /camera\)"):
        read_recording(path)


def test_files_are_never_written_over(tmp_path):
    path = tmp_path / "run.mcap"
    path.write_bytes(b"mine")
    with pytest.raises(UsageError, match="exists already"):
        RecordingFile(path, {})
    assert path.read_bytes() == b"mine"
    with pytest.raises(UsageError, match="there is no folder"):
        RecordingFile(tmp_path / "away" / "run.mcap", {})


def test_the_library_reads_the_file_with_checksums_and_index(tmp_path):
    from mcap.reader import SeekingReader

    path = tmp_path / "run.mcap"
    write_recording(path, recording())
    with path.open("rb") as file:
        reader = SeekingReader(file, validate_crcs=True)
        summary = reader.get_summary()
        counts = summary.statistics.channel_message_counts
        topics = {channel.topic: counts[ident] for ident, channel in summary.channels.items()}
        assert topics == {"/rows": 1200, "/events": 1, "/dashboard": 1}
        assert len(summary.chunk_indexes) == summary.statistics.chunk_count >= 1
        said = [json.loads(message.data) for _, _, message in reader.iter_messages(topics="/events")]
        assert said == [{"type": "connected", "port": "rtsi", "version": "2.14.0.1"}]
        assert [item.name for item in reader.iter_attachments()] == ["cell.script"]
        assert {item.name for item in reader.iter_metadata()} == {"elitescript", "facts"}
