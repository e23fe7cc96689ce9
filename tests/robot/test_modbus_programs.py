"""Programs with MODBUS TCP signals: what each command returns, and when it is an alarm."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.environment.memory import MemoryEnvironment
from elitescript.kernel import RobotOptions
from elitescript.kernel.kernel import Kernel
from elitescript.messages.events import ChannelActivity
from elitescript.messages.inputs import ChannelClosed, ChannelData, ChannelOpened, Reboot, RunUnit
from elitescript.messages.outputs import CloseChannel, OpenChannel, SendChannel
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.tcp import tcp_frame
from elitescript.modbus.slave import MemoryTables, Slave, TcpSlave
from tests.modbus.bench import Device, Network

ADD = 'modbus_add_signal("10.0.0.9", 255, '


class Cell:
    """A robot, and a device that it reaches at port 502."""

    def __init__(self, firmware="2.14"):
        self.network = Network()
        self.device = self.network.devices[502] = Device()
        self.robot = VirtualRobot(firmware=firmware, world=MemoryEnvironment(channels=self.network))

    def run(self, *lines, until_s=60.0):
        """Run a program of these lines; return what it has printed."""
        text = "def main():\n" + "".join(f"  {line}\n" for line in lines) + "end\n"
        self.result = self.robot.run(text, until_s=until_s)
        return self.result.printed


def alarm(cell, *lines):
    """The alarm that ends a program."""
    cell.run(*lines)
    assert cell.result.state == "alarm"
    return cell.result.alarms[0]


class TestValues:
    def test_each_type_of_signal_has_its_type_of_value(self):
        cell = Cell()
        cell.device.tables.discrete_inputs[3] = 1
        cell.device.tables.coils[4] = 1
        printed = cell.run(
            ADD + '3, 0, "di")',
            ADD + '3, 1, "do", False, 3)',
            ADD + '3, 2, "ri")',
            ADD + '3, 3, "ro", False, 2)',
            'modbus_add_rw_signal("10.0.0.9", 255, 0, 2, 10, 1, "rw")',
            "sleep(0.2)",
            'print(modbus_get_signal_status("di"))',
            'print(modbus_get_signal_status("do", True))',
            'print(modbus_get_signal_status("ri"))',
            'print(modbus_get_signal_status("ro"))',
            'print(modbus_get_signal_status("rw"))',
        )
        assert printed == ["True", "[False, True, False]", "3", "[103, 104]", "[100, 101]"]

    def test_before_the_first_answer_everything_is_zero(self):
        printed = Cell().run(
            ADD + '3, 0, "a")',
            ADD + '3, 3, "b", False, 2)',
            'print(modbus_get_signal_status("a"), modbus_get_signal_status("b"))',
        )
        assert printed == ["False [0, 0]"]

    def test_arguments_may_be_named_as_the_manuals_spell_them(self):
        printed = Cell().run(
            'modbus_add_signal(IP="10.0.0.9", slave_number=255, signal_address=5, singal_type=3, singal_name="x")',
            'modbus_set_signal_update_frequency("x", update_freqency=100)',
            "sleep(0.1)",
            'print(modbus_get_signal_status("x"))',
            'modbus_delete_signal(singal_name="x")',
        )
        assert printed == ["105"]

    @pytest.mark.parametrize(("given", "unit"), [(1, 1), (247, 247), (248, 255), (254, 255), (255, 255)])
    def test_slaves_248_to_254_are_255(self, given, unit):
        cell = Cell()
        cell.run(f'modbus_add_signal("10.0.0.9", {given}, 0, 3, "x")', "sleep(0.1)")
        assert {unit for _, unit, _ in cell.device.requests} == {unit}


class TestOutputs:
    @pytest.mark.parametrize(("value", "written"), [(300, 300), (70000, 4464), (-1, 65535), (True, 1)])
    def test_a_register_takes_the_low_16_bits(self, value, written):
        cell = Cell()
        printed = cell.run(
            ADD + '7, 3, "x")',
            f'modbus_set_output_register("x", {value})',
            "sleep(0.2)",
            'print(modbus_get_signal_status("x"))',
        )
        assert printed == [str(written)]
        assert cell.device.tables.holding_registers[7] == written
        assert set(cell.device.writes()) == {pdu.write_register(7, written)}

    def test_coils_take_levels(self):
        cell = Cell()
        cell.run(
            ADD + '7, 1, "one")',
            ADD + '20, 1, "more", False, 3)',
            'modbus_set_output_signal("one", True)',
            'modbus_set_output_signal("more", [1, False])',
            "sleep(0.2)",
        )
        assert cell.device.tables.coils[7] == 1
        assert cell.device.tables.coils[20:23] == [1, 0, 0]

    def test_a_read_write_signal_writes_its_own_registers(self):
        cell = Cell()
        printed = cell.run(
            'modbus_add_rw_signal("10.0.0.9", 255, 0, 3, 1, 2, "x")',
            "sleep(0.1)",
            'modbus_set_output_register("x", [5, 6])',
            "sleep(0.2)",
            'print(modbus_get_signal_status("x"))',
        )
        assert printed == ["[100, 5, 6]"]
        assert set(cell.device.writes()) == {pdu.read_write_registers(0, 3, 1, [5, 6])}

    def test_a_tied_output_follows_the_end_of_the_program(self):
        cell = Cell()
        cell.run(
            ADD + '7, 1, "x")',
            'modbus_set_output_signal("x", True)',
            'modbus_set_runstate_dependent_choice("x", 1)',
            "sleep(0.5)",
        )
        assert cell.device.writes()[0] == pdu.write_coil(7, 1)
        assert cell.device.writes()[-1] == pdu.write_coil(7, 0)

    def test_a_paused_program_counts_as_running(self):
        cell = Cell()
        cell.robot.start(
            "def main():\n" + f'  {ADD}7, 1, "x")\n  modbus_set_runstate_dependent_choice("x", 3)\n  sleep(9)\nend\n'
        )
        cell.robot.advance(1.0)
        cell.robot.pause()
        cell.robot.advance(1.0)
        assert cell.device.tables.coils[7] == 1


class TestErrors:
    def test_codes_come_in_a_list(self):
        printed = Cell().run(
            ADD + '3, 3, "good")',
            ADD + '60000, 3, "bad")',
            'modbus_add_signal("10.0.0.9", 255, 0, 3, "far", False, 1, 503)',
            'print(modbus_get_error("good"))',
            "sleep(0.004)",
            'print(modbus_get_error("good"))',
            "sleep(0.1)",
            'print(modbus_get_error("good"), modbus_get_error("bad"), modbus_get_error("far"))',
            'print(modbus_get_error("far", 1), modbus_get_error("far", 2), modbus_get_error("far", 0))',
        )
        assert printed == ["[-2, 0]", "[-1, 0]", "[0, 0] [2, 0] [-2, 111]", "[-2] [111] [-2, 111]"]

    def test_the_time_since_it_worked_is_zero_while_it_does(self):
        cell = Cell()
        printed = cell.run(
            ADD + '60000, 3, "bad")',
            ADD + '3, 3, "good")',
            "sleep(2)",
            'print(modbus_get_time_since_signal_invalid("bad"), modbus_get_time_since_signal_invalid("good"))',
        )
        assert printed == ["2.0 0.0"]

    @pytest.mark.parametrize("use", ['modbus_get_signal_status("x")', 'modbus_set_output_register("x", 1)'])
    def test_a_signal_may_be_faulty_for_5_s_and_no_longer(self, use):
        cell = Cell()
        lines = ADD + '60000, 3, "x")', "sleep(4.9)", use
        cell.run(*lines)
        assert cell.result.state == "finished"
        found = alarm(Cell(), *lines, "sleep(0.2)", use)
        assert found.code == "R134"
        assert "the MODBUS signal 'x' has not worked for 5.1 s (device 2, connection 0)" in found.text

    def test_the_watchdog_can_be_set(self):
        found = alarm(
            Cell(),
            ADD + '60000, 3, "x")',
            'modbus_set_signal_watchdog("x", 0.5)',
            "sleep(0.6)",
            'modbus_get_signal_status("x")',
        )
        assert found.code == "R134"
        cell = Cell()
        cell.run(
            ADD + '60000, 3, "x")', 'modbus_set_signal_watchdog("x", 300)', "sleep(50)", 'modbus_get_signal_status("x")'
        )
        assert cell.result.state == "finished"

    def test_a_faulty_signal_can_be_caught(self):
        printed = Cell().run(
            ADD + '60000, 3, "x")',
            'modbus_set_signal_watchdog("x", 0)',
            "sleep(0.1)",
            "try:",
            '  modbus_get_signal_status("x")',
            "except RuntimeError as error:",
            '  print("caught")',
            "end",
        )
        assert printed == ["caught"]

    @pytest.mark.parametrize(
        "call",
        [
            'modbus_delete_signal("y")',
            'modbus_get_signal_status("y")',
            'modbus_set_output_register("y", 1)',
            'modbus_set_output_signal("y", True)',
            'modbus_set_runstate_dependent_choice("y", 1)',
            'modbus_set_signal_update_frequency("y", 10)',
            'modbus_set_signal_watchdog("y", 10)',
            'modbus_get_error("y")',
            'modbus_get_time_since_signal_invalid("y")',
        ],
    )
    def test_an_unknown_name_is_an_alarm(self, call):
        found = alarm(Cell(), ADD + '0, 3, "x")', call)
        assert found.code == "R104"
        assert f"{call.partition('(')[0]}: there is no MODBUS signal 'y'" in found.text

    @pytest.mark.parametrize(
        ("call", "code", "text"),
        [
            (ADD + '0, 4, "x")', "R102", "signal_type must be in [0, 3], got 4"),
            (ADD + '65536, 3, "x")', "R102", "signal_address must be in [0, 65535], got 65536"),
            (ADD + '0, 3, "x", False, 124)', "R102", "registers_count must be in [1, 123], got 124"),
            (ADD + '0, 3, "x", False, 1, 0)', "R102", "port must be in [1, 65535], got 0"),
            (ADD + '65535, 3, "x", False, 2)', "R104", "registers_count must be <= 1, as the last address is 65535"),
            (ADD + '0, 3, "")', "R104", "signal_name is empty"),
            ('modbus_add_signal("", 255, 0, 3, "x")', "R104", "IP is empty"),
            ('modbus_add_signal("10.0.0.9", 256, 0, 3, "x")', "R102", "slave_number must be in [0, 255], got 256"),
            (
                'modbus_add_rw_signal("10.0.0.9", 255, 0, 1, 0, 122, "x")',
                "R104",
                "write_register_count must be <= 121, as more do not fit into a request, got 122",
            ),
            (
                'modbus_add_rw_signal("10.0.0.9", 255, 65530, 9, 0, 1, "x")',
                "R104",
                "read_register_count must be <= 6",
            ),
            ('modbus_set_output_register("ro", [])', "R104", "register_value is an empty list"),
            ('modbus_set_output_register("ro", [1, 2, 3])', "R104", "'ro' takes 2 values, got 3"),
            ('modbus_set_output_register("do", 1)', "R104", "'do' is no output register"),
            ('modbus_set_output_register("ri", 1)', "R104", "'ri' is no output register"),
            ('modbus_set_output_signal("ro", True)', "R104", "'ro' is no digital output"),
            ('modbus_set_output_signal("do", [])', "R104", "digital_value is an empty list"),
            ('modbus_set_output_signal("do", [True, True])', "R104", "'do' takes 1 values, got 2"),
            ('modbus_set_runstate_dependent_choice("ro", 1)', "R104", "'ro' is no digital output"),
            ('modbus_set_runstate_dependent_choice("do", 4)', "R102", "runstate_choice must be in [0, 3], got 4"),
            (
                'modbus_set_signal_update_frequency("do", 251)',
                "R102",
                "update_frequency must be in [0, 250] Hz, got 251",
            ),
            ('modbus_set_signal_watchdog("do", 301)', "R102", "timeout must be in [0, 300] s, got 301"),
            ('modbus_get_error("do", 3)', "R102", "error_source must be in [0, 2], got 3"),
            (
                'modbus_send_custom_command("10.0.0.9", 1, 128, [])',
                "R102",
                "function_code must be in [1, 127], got 128",
            ),
            ('modbus_send_custom_command("10.0.0.9", 1, 6, [256])', "R102", "in [0, 255], got 256"),
            ('modbus_send_custom_command("10.0.0.9", 1, 6, [0] * 253)', "R104", "data has 253 bytes, at most 252"),
            ('modbus_reset_connection("10.0.0.8")', "R104", "no MODBUS signal uses a connection to 10.0.0.8:502"),
        ],
    )
    def test_what_makes_no_sense_is_an_alarm(self, call, code, text):
        found = alarm(Cell(), ADD + '0, 3, "ro", False, 2)', ADD + '0, 1, "do")', ADD + '0, 2, "ri")', call)
        assert found.code == code
        assert text in found.text

    def test_the_201st_signal_is_an_alarm(self):
        found = alarm(Cell(), "for n in range(201):", "  " + ADD + "n, 3, str(n))", "end")
        assert "there are 200 MODBUS signals already" in found.text

    def test_reading_from_slave_0_is_a_warning(self):
        cell = Cell()
        printed = cell.run(
            'modbus_add_signal("10.0.0.9", 0, 0, 2, "x")', "sleep(0.2)", 'print(modbus_get_signal_status("x"))'
        )
        assert printed == ["0"]
        assert cell.device.requests == []
        assert cell.result.warnings == ["a broadcast gets no answer: the MODBUS signal 'x' stays at 0"]


class TestCustomCommands:
    def test_bytes_go_out_behind_the_function_code(self):
        cell = Cell()
        cell.run('modbus_send_custom_command("10.0.0.9",103,6,[17,32,2,88],True,502)', "sleep(0.1)")
        assert [(unit, request) for _, unit, request in cell.device.requests] == [
            (103, pdu.write_register(0x1120, 600))
        ]

    def test_firmware_2_10_sends_function_6_alone_and_to_slaves_up_to_247_or_255(self):
        found = alarm(Cell("2.10"), 'modbus_send_custom_command("10.0.0.9", 1, 16, [])')
        assert found.code == "R102"
        assert "function_code must be 6 in firmware 2.10, got 16" in found.text
        for firmware, unit in (("2.10", 255), ("2.14", 250)):
            cell = Cell(firmware)
            cell.run('modbus_send_custom_command("10.0.0.9", 250, 6, [0, 1, 0, 2])', "sleep(0.1)")
            assert cell.device.requests[0][1] == unit

    def test_it_can_be_repeated(self):
        cell = Cell()
        cell.run('modbus_send_custom_command("10.0.0.9", 1, 6, [0, 1, 0, 2], False)', "sleep(1)")
        assert len(cell.device.requests) in (10, 11)

    def test_what_the_device_refuses_is_a_warning(self):
        cell = Cell()
        cell.run('modbus_send_custom_command("10.0.0.9", 1, 99, [1])', "sleep(1)")
        assert cell.result.warnings == ["a MODBUS request to 10.0.0.9:502, slave 1: exception 1: illegal function"]


class TestReset:
    def test_a_blocking_reset_waits_for_the_outcome(self):
        cell = Cell()
        printed = cell.run(
            ADD + '3, 3, "x")',
            "sleep(0.1)",
            'modbus_reset_connection("10.0.0.9", True)',
            'print(modbus_get_error("x")[0] >= -1)',
        )
        assert printed == ["True"]
        assert len(cell.network.opened) == 2
        assert cell.result.time_s == pytest.approx(0.108)

    def test_another_one_does_not(self):
        cell = Cell()
        cell.run(ADD + '3, 3, "x")', "sleep(0.1)", 'modbus_reset_connection("10.0.0.9", False)')
        assert cell.result.time_s == pytest.approx(0.1)

    def test_a_device_that_never_answers_is_waited_for_2_s(self):
        cell = Cell()
        cell.network.dead.add(503)
        cell.run(
            'modbus_add_signal("10.0.0.9", 255, 0, 3, "x", False, 1, 503)',
            "sleep(0.1)",
            'modbus_reset_connection(ip="10.0.0.9", port=503)',
        )
        assert cell.result.state == "finished"
        assert cell.result.time_s == pytest.approx(2.104)

    def test_another_thread_that_resets_again_and_again_does_not_make_it_longer(self):
        cell = Cell()
        cell.network.dead.add(503)
        printed = cell.run(
            'modbus_add_signal("10.0.0.9", 255, 0, 3, "x", False, 1, 503)',
            "def again():",
            "  while True:",
            '    modbus_reset_connection("10.0.0.9", False, 503)',
            "    sleep(0.5)",
            "  end",
            "end",
            "handle = start_thread(again, ())",
            "sleep(0.1)",
            "import time",
            "begin = time.time()",
            'modbus_reset_connection("10.0.0.9", True, 503)',
            "print(round(time.time() - begin, 3))",
            "stop_thread(handle)",
        )
        assert printed == ["2.004"]

    def test_a_waiting_thread_can_be_stopped(self):
        cell = Cell()
        cell.network.dead.add(503)
        cell.run(
            'modbus_add_signal("10.0.0.9", 255, 0, 3, "x", False, 1, 503)',
            "def wait():",
            '  modbus_reset_connection("10.0.0.9", True, 503)',
            "end",
            "handle = start_thread(wait, ())",
            "sleep(0.1)",
            "stop_thread(handle)",
            "sleep(0.1)",
        )
        assert cell.result.state == "finished"
        assert cell.result.time_s == pytest.approx(0.2)


class TestLifetime:
    def test_a_program_without_signals_imports_nothing_of_it(self):
        import subprocess
        import sys

        code = (
            "import sys; from elitescript import VirtualRobot; VirtualRobot().run('def main():\\n  sleep(1)\\nend\\n');"
            "print([name for name in sys.modules if name.startswith('elitescript.modbus')])"
        )
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert done.stdout.strip() == "[]"

    def test_a_run_ends_though_signals_exist_and_the_next_one_finds_them(self):
        cell = Cell()
        cell.run(ADD + '3, 3, "x")', "sleep(0.1)")
        assert cell.result.time_s == pytest.approx(0.1)
        assert cell.network.closed == []
        assert cell.run('print(modbus_get_signal_status("x"))') == ["103"]
        assert cell.run('modbus_delete_signal("x")', "sleep(0.1)") == []
        assert cell.network.closed == [1]
        assert "there is no MODBUS signal 'x'" in alarm(cell, 'modbus_get_signal_status("x")').text

    def test_they_outlive_an_alarm_too(self):
        cell = Cell()
        alarm(cell, ADD + '3, 3, "x")', "sleep(0.1)", "1 / 0")
        assert cell.run('print(modbus_get_signal_status("x"))') == ["103"]

    def test_what_is_set_in_the_last_tick_is_written(self):
        cell = Cell()
        cell.run(
            ADD + '3, 3, "x")',
            ADD + '4, 1, "y")',
            'modbus_set_output_register("x", 7)',
            'modbus_set_output_signal("y", True)',
        )
        assert (cell.result.time_s, cell.result.undelivered) == (0.0, [])
        assert cell.device.tables.holding_registers[3] == 7
        assert cell.device.tables.coils[4] == 1

    def test_a_signal_without_a_frequency_too(self):
        cell = Cell()
        cell.run(
            ADD + '3, 3, "x")',
            'modbus_set_signal_update_frequency("x", 0)',
            "sleep(1)",
            'modbus_set_output_register("x", 7)',
        )
        assert cell.device.tables.holding_registers[3] == 7

    def test_and_one_that_is_deleted_at_once(self):
        cell = Cell()
        cell.run(ADD + '3, 3, "x")', "sleep(1)", 'modbus_set_output_register("x", 7)', 'modbus_delete_signal("x")')
        assert cell.device.tables.holding_registers[3] == 7
        assert cell.device.writes() == [pdu.write_register(3, 7)]

    @pytest.mark.parametrize("is_once", [True, False])
    def test_a_request_of_the_last_tick_is_sent(self, is_once):
        cell = Cell()
        cell.run(f'modbus_send_custom_command("10.0.0.9", 255, 6, [0, 9, 1, 2], {is_once})')
        assert cell.device.writes() == [pdu.write_register(9, 258)]
        assert cell.result.undelivered == []

    def test_a_broadcast_too(self):
        cell = Cell()
        cell.run('modbus_send_custom_command("10.0.0.9", 0, 6, [0, 9, 1, 2])')
        assert cell.device.writes() == [pdu.write_register(9, 258)]
        assert cell.result.undelivered == []

    def test_what_does_not_arrive_is_given_up_and_said(self):
        cell = Cell()
        del cell.network.devices[502]
        cell.run(
            ADD + '3, 3, "x")',
            'modbus_set_output_register("x", 7)',
            'modbus_send_custom_command("10.0.0.8", 1, 6, [0, 9, 1, 2])',
        )
        assert cell.result.state == "finished"
        assert cell.result.undelivered == [
            "a MODBUS request to 10.0.0.8:502, slave 1: not sent, connection refused",
            "MODBUS signal 'x' to 10.0.0.9:502, slave 255",
        ]
        assert cell.robot.time_s == pytest.approx(2.0, abs=0.1)
        cell.run("sleep(1)")
        assert (cell.result.undelivered, cell.robot.time_s) == ([], pytest.approx(3.0, abs=0.1))

    def test_a_device_that_refuses_is_not_waited_for(self):
        cell = Cell()
        cell.run(ADD + '60000, 3, "x")', 'modbus_set_output_register("x", 7)')
        assert cell.result.undelivered == []
        assert any("illegal data address" in text for text in cell.result.warnings)
        assert cell.robot.time_s < 0.5

    def test_time_leaps_between_turns(self):
        cell = Cell()
        cell.run(ADD + '3, 3, "x")', 'modbus_set_signal_update_frequency("x", 1)', "sleep(50)")
        assert len(cell.device.requests) == 51

    def test_a_secondary_program_uses_the_same_signals_and_waits_for_nothing(self):
        cell = Cell()
        cell.robot.start("def main():\n" + f'  {ADD}3, 3, "x")\n  sleep(2)\nend\n')
        cell.robot.advance(0.5)
        cell.robot.submit_secondary(
            'sec look():\n  print(modbus_get_signal_status("x"))\n  modbus_reset_connection("10.0.0.9")\n'
            '  print("done")\nend\n'
        )
        cell.robot.advance(0.004)
        assert cell.robot.current.printed == ["103", "done"]

    def test_reruns_are_identical(self):
        def history():
            cell = Cell()
            cell.device.latency = 7
            cell.run(
                *(ADD + f'{n}, 3, "s{n}")' for n in range(30)),
                *(f'modbus_set_signal_update_frequency("s{n}", {n * 8})' for n in range(30)),
                "sleep(3)",
            )
            return cell.device.requests

        assert history() == history()


class Served:
    """A served controller, its channels held by the test, with a slave behind each."""

    def __init__(self):
        self.kernel = Kernel(RobotOptions(power_on=True))
        self.slave = Slave(MemoryTables(holding_registers=[5] * 10))
        self.connections = {}
        self.inputs = []
        self.printed = []
        self.opened = []
        self.closed = []

    def program(self, *lines):
        text = "def main():\n" + "".join(f"  {line}\n" for line in lines) + "end\n"
        self.inputs.append(RunUnit("test", "program", text))

    def run(self, ticks):
        for _ in range(ticks):
            output = self.kernel.tick_and_snapshot(self.inputs)
            self.printed += [event.text for event in output.events if type(event).__name__ == "Printed"]
            self.inputs = []
            for request in output.requests:
                if isinstance(request, OpenChannel):
                    self.opened.append((request.address, request.port))
                    self.connections[request.channel] = TcpSlave(self.slave)
                    self.inputs.append(ChannelOpened(request.channel, True))
                elif isinstance(request, SendChannel):
                    answer = self.connections[request.channel].take(request.data)
                    self.inputs.append(ChannelData(request.channel, answer))
                elif isinstance(request, CloseChannel):
                    self.closed.append(request.channel)


class TestServed:
    def test_signals_outlive_the_program(self):
        served = Served()
        served.program('modbus_add_signal("10.0.0.9", 255, 0, 3, "x")', "sleep(0.2)")
        served.run(200)
        served.slave.tables.holding_registers[0] = 6
        served.run(30)
        served.program('print(modbus_get_signal_status("x"))')
        served.run(10)
        assert served.printed == ["6"]
        assert served.opened == [("10.0.0.9", 502)]

    def test_a_reboot_forgets_them(self):
        served = Served()
        served.program('modbus_add_signal("10.0.0.9", 255, 0, 3, "x")', "sleep(0.2)")
        served.run(200)
        served.inputs.append(Reboot("test"))
        served.run(10)
        assert served.closed == [1]

    def test_a_lost_connection_is_made_anew_between_programs(self):
        served = Served()
        served.program('modbus_add_signal("10.0.0.9", 255, 0, 3, "x")', "sleep(0.2)")
        served.run(200)
        served.inputs.append(ChannelClosed(1))
        served.run(60)
        assert len(served.opened) == 2


def test_an_answer_of_another_slave_is_an_error_of_the_signal():
    cell = Cell()
    cell.device.alter = lambda frame, answer: tcp_frame(frame.transaction, 9, answer)
    printed = cell.run(ADD + '3, 3, "x")', "sleep(0.1)", 'print(modbus_get_error("x"))')
    assert printed == ["[9, 0]"]


@pytest.mark.parametrize("pace", [None, lambda tick: None], ids=["leaps", "every tick"])
def test_a_connection_is_closed_in_the_tick_after_its_last_signal_is_deleted(pace):
    cell = Cell()
    lines = (f'{ADD}0, 3, "x")', "sleep(0.51)", 'modbus_delete_signal("x")', "sleep(1)")
    run = cell.robot.start("def main():\n  " + "\n  ".join(lines) + "\nend\n")
    cell.robot.advance(2.0, pace=pace)
    changes = [event for event in run.events if isinstance(event, ChannelActivity)]
    assert (changes[-1].what, changes[-1].tick) == ("closed", 129)
