"""The record of a process: what is written is read, whatever else stands there is refused."""

from __future__ import annotations

import random
import threading
from contextlib import nullcontext

import pytest

from elitescript.coverage.recording import CELL, Recorder, counters_max, digest_of, read_record
from elitescript.language.compiler import compile_unit
from elitescript.language.options import Options
from elitescript.language.text.source import SourceFile
from tests.debugger.random_programs import random_program

TEXT = "def a():\n  sleep(1)\nend\n"


def recorder(size: int = 4096) -> tuple[bytearray, Recorder]:
    block = bytearray(size)
    return block, Recorder(memoryview(block), nullcontext())


class TestRoundTrip:
    def test_counters_and_facts(self):
        block, record = recorder()
        first = record.counters("/cell.script", TEXT)
        assert first is not None
        record.cells[first] += 5
        record.cells[first + 1] += 2**40
        record.fact("alarm", "R110")
        record.fact("alarm", "R110")
        record.fact("safety", "NORMAL")
        found = read_record(bytes(block))
        (program,) = found.programs
        assert (program.name, program.digest, program.counts[:3]) == ("/cell.script", digest_of(TEXT), (5, 2**40, 0))
        assert found.facts == {("alarm", "R110"), ("safety", "NORMAL")}
        assert found.is_complete

    def test_a_text_has_the_same_counters_again(self):
        _, record = recorder()
        first = record.counters("/cell.script", TEXT)
        assert record.counters("<primary#1>", TEXT.replace("\n", "\r\n") + "\n\n") == first
        assert record.counters("/cell.script", TEXT + "#") != first

    def test_a_process_that_has_done_nothing(self):
        block, _ = recorder()
        assert read_record(bytes(block)) == ((), frozenset(), True)

    def test_a_copy_has_the_same_programs_by_the_same_numbers_and_no_counts(self):
        block, record = recorder()
        first = record.counters("/cell.script", TEXT)
        record.cells[first] += 5
        record.fact("alarm", "R110")
        other = bytearray(4096)
        copy = record.copied(other, nullcontext())
        assert copy.counters("/cell.script", TEXT) == first
        copy.cells[first + 1] += 1
        assert copy.counters("/more.script", TEXT + "#") == record.counters("/else.script", TEXT + "##")
        found = read_record(bytes(other))
        assert [(row.name, row.counts[:3]) for row in found.programs] == [
            ("/cell.script", (0, 1, 0)),
            ("/more.script", (0, 0, 0)),
        ]
        assert found.facts == {("alarm", "R110")}
        assert [row.counts[:2] for row in read_record(bytes(block)).programs] == [(5, 0), (0, 0)]

    def test_threads_get_counters_of_their_own(self):
        block = bytearray(1 << 20)
        record = Recorder(memoryview(block), threading.Lock())
        firsts: list[int | None] = []

        def work(number: int) -> None:
            for text in range(50):
                firsts.append(record.counters("a", f"x = {number * 50 + text}\n"))

        threads = [threading.Thread(target=work, args=(number,)) for number in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(set(firsts)) == 200
        assert len(read_record(bytes(block)).programs) == 200


class TestRoom:
    def test_a_full_block_says_so(self):
        block, record = recorder(40 * CELL)
        assert record.counters("/a", TEXT) is not None
        assert record.counters("/b", TEXT * 9) is None
        assert record.counters("/b", TEXT * 9) is None
        found = read_record(bytes(block))
        assert [program.name for program in found.programs] == ["/a"]
        assert not found.is_complete

    def test_every_program_fits_its_counters(self):
        generator = random.Random(7)
        for _ in range(40):
            text = random_program(generator)
            unit = compile_unit(SourceFile("a", text), Options(probes="coverage"))
            assert unit.probes.size <= counters_max(text)

    @pytest.mark.parametrize("text", ["a();b();c()", "if a: b()", "def f(): pass\nend", "match a:\n case 1: b()\nend"])
    def test_so_does_a_short_one(self, text):
        unit = compile_unit(SourceFile("a", text), Options(probes="coverage"))
        assert 0 < unit.probes.size <= counters_max(text)


class TestDamage:
    def test_what_is_no_record_is_refused(self):
        for data in (b"", b"short", bytes(4096), b"x" * 4096):
            with pytest.raises(ValueError, match="no record"):
                read_record(data)

    def test_damage_is_refused_or_read_but_never_more(self):
        block, record = recorder(1024)
        record.counters("/cell.script", TEXT)
        record.fact("alarm", "R110")
        generator = random.Random(3)
        refused = 0
        for _ in range(600):
            damaged = bytearray(block)
            for _ in range(generator.randrange(1, 4)):
                damaged[generator.randrange(8, 200)] = generator.randrange(256)
            try:
                read_record(bytes(damaged))
            except ValueError:
                refused += 1
        assert refused > 150
