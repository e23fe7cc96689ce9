"""Observers of signals and of MODBUS signals: each as a function of what it is given, and in a run."""

import pytest

from elitescript import VirtualRobot
from elitescript.controller.signals.signal_watch import LOOKS_MAX, POLLING_TICKS, SignalWatch
from elitescript.controller.tasks import NoProgram
from elitescript.findings.observers.cut_registers import CutRegisters
from elitescript.findings.observers.early_modbus import EarlyModbus
from elitescript.findings.observers.missed_inputs import MissedInputs
from elitescript.findings.observers.pulses_in_a_tick import PulsesInATick
from elitescript.findings.observers.replaced_modbus import FEW_SETS, ReplacedModbus
from elitescript.language import cleanup
from elitescript.language.compiler import compile_task
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import Warned
from elitescript.messages.observations import (
    InputMissed,
    ModbusReadAgain,
    ModbusReadEarly,
    ModbusReplaced,
    RegisterCut,
    SignalPulsed,
)
from elitescript.testing.world import ModbusDevice, World


def told(observer, *seen):
    rows = [row for one in seen for row in observer.see(one)] + list(observer.end("finished"))
    return [(row.code, row.line, row.text) for row in rows]


class TestPulsesInATick:
    @pytest.mark.parametrize(
        ("is_back", "is_cleanup", "code"), [(True, False, "W288"), (False, False, "N285"), (True, True, "N285")]
    )
    def test_what_comes_back_is_a_warning(self, is_back, is_cleanup, code):
        seen = SignalPulsed(9, "flag[3]", 5, "main", 4, 7, 8, is_back, is_cleanup)
        ((found, line, text),) = told(PulsesInATick(), seen, seen)
        assert (found, line) == (code, 5)
        assert text.startswith("flag[3] was 7 (set in line 4) and became 8 in the same tick")


def test_a_missed_input_once_a_line():
    seen = InputMissed(9, "standard_digital_in[3]", 5, "main", 2, 25)
    ((code, line, text),) = told(MissedInputs(), seen, seen)
    assert (code, line) == ("W289", 5)
    assert "changed 2 times between two looks of this line, which looks every 0.1 s" in text


class TestEarlyModbus:
    EARLY = ModbusReadEarly(9, "level", 5, "main", "0", 0)

    def test_what_is_never_read_again_is_a_warning(self):
        ((code, line, text),) = told(EarlyModbus(), self.EARLY, self.EARLY)
        assert (code, line) == ("W285", 5)
        assert "'level' had no value yet, in 2 readings, it was added 0 s before: the 0 that was read" in text

    def test_a_line_that_reads_again_is_a_note(self):
        seen = [self.EARLY, self.EARLY, ModbusReadAgain(19, "level", 5, "main")]
        assert [row[:2] for row in told(EarlyModbus(), *seen)] == [("N284", 5)]


class TestReplacedModbus:
    @staticmethod
    def replaced(sets, span_ticks, hz=10):
        return ModbusReplaced(9, "cmd", 5, "main", "1", "2", 8, hz, sets, span_ticks, is_back=False)

    @pytest.mark.parametrize(
        ("sets", "span_ticks", "code"),
        [(2, 8, "W286"), (FEW_SETS, 160, "W286"), (FEW_SETS + 1, 168, "N286"), (100, 250 * 60, "W286")],
    )
    def test_a_stream_is_a_note(self, sets, span_ticks, code):
        ((found, line, text),) = told(ReplacedModbus(), self.replaced(sets, span_ticks))
        assert (found, line) == (code, 5)
        assert (
            text
            == "1 in the MODBUS signal 'cmd' was replaced by 2 after 0.032 s, before it was sent: the signal has 10 Hz"
        )

    def test_several_are_one(self):
        ((_, _, text),) = told(ReplacedModbus(), *[self.replaced(2, 8)] * 3)
        assert text.endswith("; others were too, up to line 5")


@pytest.mark.parametrize(
    ("value", "sent", "code"),
    [(70000, 4464, "W287"), (-5, 65531, "N287"), (-32768, 32768, "N287"), (-32769, 32767, "W287")],
)
def test_cut_registers(value, sent, code):
    seen = RegisterCut(9, "a", 5, "main", value, sent)
    ((found, line, text),) = told(CutRegisters(), seen, seen)
    assert (found, line) == (code, 5)
    assert f"{value} becomes {sent} in the register 'a'" in text


class AtLine(NoProgram):
    def __init__(self, line):
        self.caller = ("main", line)


class TestSignalWatch:
    KEY = ("standard_digital_in", 3)

    def looks(self, *steps, line=5):
        """Return the observations of looks; each step is a tick and how often the input changes before it."""
        seen = []
        watch = SignalWatch(seen.append, {}, lambda: AtLine(line))
        for tick, changes in steps:
            for _ in range(changes):
                watch.input_changed(self.KEY)
            if watch.inputs:
                watch.looked(self.KEY, tick)
        return seen

    def test_two_changes_and_a_look_soon_after(self):
        (seen,) = self.looks((10, 0), (20, 2), (45, 0), (70, 0))
        assert (seen.signal, seen.line, seen.changes, seen.step_ticks) == ("standard_digital_in[3]", 5, 2, 25)

    @pytest.mark.parametrize(
        "steps",
        [[(10, 1), (20, 1), (30, 1)], [(10, 2)], [(10, 2), (10, 0)], [(10, 2), (11 + POLLING_TICKS, 0)]],
    )
    def test_what_is_none(self, steps):
        assert self.looks(*steps) == []

    def test_another_line_polls_nothing(self):
        seen, lines = [], iter((5, 6))
        watch = SignalWatch(seen.append, {}, lambda: AtLine(next(lines)))
        watch.input_changed(self.KEY)
        watch.input_changed(self.KEY)
        watch.looked(self.KEY, 10)
        watch.looked(self.KEY, 20)
        assert seen == []

    def test_a_program_that_looks_elsewhere_is_not_slowed_for_ever(self):
        watch = SignalWatch(lambda seen: None, {}, NoProgram)
        watch.input_changed(self.KEY)
        for tick in range(LOOKS_MAX + 1):
            watch.looked(("standard_digital_in", 0), tick)
        assert not watch.inputs


class Plc(ModbusDevice):
    holding_registers = (0, 0)
    input_registers = (7,)
    coils = (0,)
    address = "10.0.0.9"
    port = 502


def found(*body, world=()):
    text = "def f():\n" + "".join(f"  {line}\n" for line in body) + "end\n"
    run = VirtualRobot("CS66", world=World(list(world))).run(text)
    return [(row.code, row.line) for row in run.findings if row.code[1:] >= "280"]


class TestInRuns:
    @pytest.mark.parametrize(
        "write",
        [
            "set_standard_digital_out(0, {})",
            "set_configurable_digital_out(0, {})",
            "set_tool_digital(0, {})",
            "write_output_boolean_register(0, {})",
            "write_output_integer_register(0, int({}))",
            "set_flag(0, {})",
        ],
    )
    def test_on_and_off(self, write):
        on, off = write.format(True), write.format(False)
        assert found(on, off) == [("W288", 3)]
        assert found(on, "sync()", off) == []
        assert found(off, off) == []

    @pytest.mark.parametrize("block", ["except ZeroDivisionError:", "finally:"])
    def test_on_and_off_through_a_cleanup_is_a_note(self, block):
        body = ["try:", "  set_flag(0, True)", "  1 / 0", block, "  set_flag(0, False)", "end"]
        assert ("N285", 6) in found(*body)

    def test_a_register_that_goes_on_is_a_note(self):
        assert found("write_output_integer_register(0, 5)", "write_output_integer_register(0, 6)") == [("N285", 3)]

    def test_the_next_program_begins_anew(self):
        robot = VirtualRobot()
        robot.run("def f():\n  set_flag(0, True)\nend\n")
        assert robot.run("def f():\n  set_flag(0, False)\nend\n").findings == ()

    ADD = 'modbus_add_signal("10.0.0.9", 255, 0, {}, "s")'

    def test_modbus_read_early(self):
        add, read = self.ADD.format(2), 'textmsg(modbus_get_signal_status("s"))'
        assert found(add, read, "sleep(0.5)", world=[Plc()]) == [("W285", 3)]
        assert found(add, "sleep(0.5)", read, world=[Plc()]) == []
        loop = ["for i in range(3):", f"  {add}", f"  {read}", "  sleep(0.5)", "end"]
        assert found(*loop, world=[Plc()]) == [("W285", 4)]
        polled = [add, 'while modbus_get_signal_status("s") == 0: sync()']
        assert found(*polled, world=[Plc()]) == [("N284", 3)]

    def test_an_output_that_was_set_has_its_value(self):
        body = [self.ADD.format(3), 'modbus_set_output_register("s", 5)', 'textmsg(modbus_get_signal_status("s"))']
        assert found(*body, world=[Plc()]) == []

    def test_modbus_replaced(self):
        def body(wait_s):
            return [
                self.ADD.format(1),
                "sleep(1)",
                'modbus_set_output_signal("s", True)',
                f"sleep({wait_s})",
                'modbus_set_output_signal("s", False)',
                "sleep(0.5)",
            ]

        assert found(*body(0.02), world=[Plc()]) == [("W286", 6)]
        assert found(*body(0.2), world=[Plc()]) == []

    def test_a_beat_counter_is_a_note(self):
        loop = ["for n in range(100):", '  modbus_set_output_register("s", n)', "  sleep(0.02)", "end"]
        assert found(self.ADD.format(3), "sleep(1)", *loop, world=[Plc()]) == [("N286", 5)]

    def test_the_same_value_again_replaces_nothing(self):
        loop = ["for n in range(10):", '  modbus_set_output_register("s", 4)', "  sync()", "end"]
        assert found(self.ADD.format(3), "sleep(1)", *loop, world=[Plc()]) == []

    def test_70000(self):
        assert found(self.ADD.format(3), 'modbus_set_output_register("s", 70000)', world=[Plc()]) == [("W287", 3)]


def test_the_text_is_read_once_for_all_pulses(monkeypatch):
    read = []
    found = cleanup.cleanup_lines
    monkeypatch.setattr(cleanup, "cleanup_lines", lambda source: read.append(source) or found(source))
    lines = "".join(f"  set_standard_digital_out(0, {n % 2 == 0})\n" for n in range(50))
    run = VirtualRobot().run(f"def job():\n{lines}end\n")
    assert len(read) == 1
    assert len(run.events) > 50


def test_a_warning_looks_at_its_line_alone(monkeypatch):
    class Noted(str):
        __slots__ = ()

        def __contains__(self, words):
            assert words != "check:", "the whole text is searched"
            return super().__contains__(words)

    robot = VirtualRobot()
    pulses = "".join(f"  set_standard_digital_out(0, {n % 2 == 0})\n" for n in range(4))
    unit = compile_task(SourceFile("job.script", f"def job():\n{pulses}end  # check: ignore\n"))
    object.__setattr__(unit.source, "text", Noted(unit.source.text))
    assert any(isinstance(event, Warned) for event in robot.run(unit).events)
