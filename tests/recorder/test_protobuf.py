"""Rows as Protocol Buffers: the bytes by hand, by the `protobuf` package where it is there, and back."""

from __future__ import annotations

import pytest

from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.recorder.channels import GROUPS, row_fields
from elitescript.recorder.protobuf import BOOL, DOUBLE, FIXED32, SFIXED32, RowField, RowLayout, layout_of

FIELDS = (
    RowField("timestamp", DOUBLE),
    RowField("q", DOUBLE, 2),
    RowField("mode", SFIXED32),
    RowField("on", BOOL),
    RowField("bits", FIXED32),
)
NUMBERS = (0.5, 1.0, -2.0, -1, True, 3)
BYTES = bytes.fromhex(
    "09 000000000000e03f"  # 1, fixed64: 0.5
    "12 10 000000000000f03f 00000000000000c0"  # 2, 16 bytes: 1.0, -2.0
    "1d ffffffff"  # 3, fixed32: -1
    "20 01"  # 4, varint: true
    "2d 03000000"  # 5, fixed32: 3
)


def test_the_bytes_of_a_row():
    layout = RowLayout(FIELDS)
    assert layout.pack(NUMBERS) == BYTES
    assert layout.size == len(BYTES)
    assert layout.columns == ("timestamp", "q.0", "q.1", "mode", "on", "bits")
    assert layout.reader(layout.columns).unpack(BYTES) == NUMBERS
    assert layout.reader(["q.1", "bits"]).unpack(BYTES) == (-2.0, 3)


def test_fields_from_the_sixteenth_on_have_two_bytes_in_front():
    layout = RowLayout([RowField(f"b{index}", BOOL) for index in range(1, 18)])
    data = layout.pack((False,) * 17)
    assert data[:4] == bytes.fromhex("0800 1000")
    assert data[-6:] == bytes.fromhex("800100 880100")


@pytest.mark.parametrize("data", [BYTES[:-1], BYTES + b"\0", b"\x0a" + BYTES[1:], BYTES[:-5] + b"\x2e" + BYTES[-4:]])
def test_other_bytes_are_no_row(data):
    assert RowLayout(FIELDS).fits(BYTES)
    assert not RowLayout(FIELDS).fits(data)


def test_a_descriptor_is_read_back():
    descriptor = RowLayout(FIELDS).descriptor("elitescript", "Row")
    assert layout_of(descriptor, {"q": 2}).fields == FIELDS


@pytest.mark.parametrize(
    ("descriptor", "lengths", "text"),
    [
        (b"", {}, "0 times a file"),
        (b"\x0a\x05\x08", {}, "ends 4 bytes behind it"),
        (b"\x0d\0\0\0\0", {}, "wire type 5"),
        (b"\x80", {}, "ends within a number"),
        (RowLayout(FIELDS).descriptor("a", "B"), {}, "the length of the list 'q' is not known"),
        (RowLayout(FIELDS).descriptor("a", "B"), {"q": 10_000}, "the length of the list 'q' is not known"),
        (
            RowLayout(FIELDS).descriptor("a", "B").replace(b"\x28\x0f", b"\x28\x05"),
            {"q": 2},
            "the field 'mode' has no type of a fixed width",
        ),
        (
            RowLayout(FIELDS).descriptor("a", "B").replace(b"\x18\x03", b"\x18\x09"),
            {"q": 2},
            "the field 'mode' has the number 9, not 3",
        ),
    ],
)
def test_descriptors_of_other_messages_are_refused(descriptor, lengths, text):
    with pytest.raises(ValueError, match=text):
        layout_of(descriptor, lengths)


@pytest.mark.peers
def test_the_protobuf_package_reads_a_row():
    pytest.importorskip("google.protobuf")
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    names = GROUPS[-1].variables
    layout = RowLayout(row_fields(names, [OUTPUTS[name].type for name in names]))
    found = descriptor_pb2.FileDescriptorSet.FromString(layout.descriptor("elitescript", "Row"))
    assert found.SerializeToString() == layout.descriptor("elitescript", "Row")
    pool = descriptor_pool.DescriptorPool()
    pool.Add(found.file[0])
    kind = message_factory.GetMessageClass(pool.FindMessageTypeByName("elitescript.Row"))
    numbers = tuple(
        index + 0.5 if code == "d" else index % 2 if code == "?" else index
        for index, code in enumerate(code for field in layout.fields for code in field.type.code * field.length)
    )
    row = kind.FromString(layout.pack(numbers))
    read = [
        number
        for field in layout.fields
        for number in (list(getattr(row, field.name)) if field.length > 1 else [getattr(row, field.name)])
    ]
    assert tuple(read) == numbers


@pytest.mark.peers
def test_the_decoder_for_viewers_reads_a_file(tmp_path):
    pytest.importorskip("mcap_protobuf")
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory

    from elitescript.recorder.writing import RecordingFile

    path = tmp_path / "run.mcap"
    file = RecordingFile(path, {})
    file.begin_rows(RowLayout(FIELDS))
    for index in range(3):
        file.row((0.5 + index, *NUMBERS[1:]), index, index)
    file.close()
    with path.open("rb") as opened:
        rows = [
            row for *_, row in make_reader(opened, decoder_factories=[DecoderFactory()]).iter_decoded_messages("/rows")
        ]
    assert [row.timestamp for row in rows] == [0.5, 1.5, 2.5]
    assert (list(rows[0].q), rows[0].mode, rows[0].on, rows[0].bits) == ([1.0, -2.0], -1, True, 3)
