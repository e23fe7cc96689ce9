import sys

import pytest

from elitescript.runtime import addresses
from elitescript.runtime.environment import bytes_without_addresses, without_addresses


class Pump:
    """Something without a text of its own."""


def named():
    """Return nothing."""


@pytest.mark.parametrize("value", [Pump(), [Pump(), object()], named, Pump().__init__, iter([]), (n for n in ()), Pump])
def test_where_an_object_is_does_not_show(value):
    text = repr(value)
    assert "0x" not in without_addresses(text)
    assert b"0x" not in bytes_without_addresses(text.encode())
    assert without_addresses(text).count("<") == without_addresses(text).count(">")


def test_texts_within_xml_are_known():
    text = f"<string>{repr(Pump()).replace('<', '&lt;').replace('>', '&gt;')}</string>"
    assert without_addresses(text) == "<string>&lt;tests.runtime.test_addresses.Pump object&gt;</string>"


def test_objects_that_are_gone_are_where_others_are():
    texts = [f"{Pump()}" for _ in range(100)]
    assert "0x" not in without_addresses(" ".join(texts))


@pytest.mark.parametrize(
    "text",
    ["<pump object at 0x7f0000001234>", "error at 0x1F", "<A at 0x10>", "plain", "<A object at 0xffffffffffffff>"],
)
def test_other_texts_stay(text):
    assert without_addresses(text) == text
    assert bytes_without_addresses(text.encode()) == text.encode()


@pytest.fixture
def no_maps(monkeypatch, tmp_path):
    """Look for objects, as on a system that does not list the memory of a process."""
    monkeypatch.setattr(addresses, "_MAPS", str(tmp_path / "maps"))


@pytest.mark.usefixtures("no_maps")
def test_a_piece_of_memory_that_was_never_asked_for_is_looked_for(monkeypatch):
    """Whatever the number of objects was at the last look."""
    memory = addresses._Memory()
    monkeypatch.setattr(addresses.sys, "getallocatedblocks", lambda: 5000)
    pump = Pump()
    assert not memory.holds(0x10)
    memory._pieces.clear()
    assert memory.holds(id(pump))


@pytest.mark.usefixtures("no_maps")
def test_an_object_without_a_collector_alone_in_its_piece_of_memory_is_found(monkeypatch):
    monkeypatch.setattr(addresses, "_PIECE_BITS", 4)
    kept = [object()]
    assert addresses._Memory().holds(id(kept[0]))


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory of a process is listed on Linux")
def test_an_object_that_nothing_but_a_name_holds_is_found(monkeypatch):
    monkeypatch.setattr(addresses, "_PIECE_BITS", 4)
    memory, pump = addresses._Memory(), object()
    assert memory.holds(id(pump))
    assert not memory.holds(0x10)


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("7f0000000000-7f0000100000 rw-p 00000000 00:00 0\n", True),
        ("55d0c0000000-55d0c0100000 rw-p 00000000 00:00 0                          [heap]\n", False),
        ("7f0000000000-7f0000080000 rw-p 00000000 00:00 0 \n", False),
        ("7f0000000000-7f0000100000 r--p 00000000 00:00 0\n", False),
        ("7f0000000000-7f0000100000 rw-p 00000000 08:01 77   /usr/lib/libc.so\n", False),
        ("", False),
    ],
)
def test_lists_of_memory_are_read(monkeypatch, tmp_path, line, expected):
    maps = tmp_path / "maps"
    maps.write_text(f"00400000-00500000 r-xp 00000000 08:01 3 /usr/bin/python\n{line}")
    monkeypatch.setattr(addresses, "_MAPS", str(maps))
    assert addresses._Memory().holds(0x7F0000080000) is expected
