"""Which change of a signal the record puts down to what."""

from elitescript import VirtualRobot
from elitescript.kernel.handlers import cause_of
from elitescript.messages.events import SignalChanged
from elitescript.testing.world import Device, ModbusClient, Schedule, Wire, World


def changes(run):
    return [(event.name, event.value, event.by, event.line) for event in run.events if isinstance(event, SignalChanged)]


def test_a_statement_of_the_program_has_its_line_wherever_it_stands():
    run = VirtualRobot("CS66").run("""def main():
  set_standard_digital_out(0, True)
  def work():
    write_output_integer_register(4, 7)
  end
  handle = start_thread(work, ())
  join_thread(handle)
  set_standard_analog_out(0, 0.5)
end
""")
    assert changes(run) == [
        ("standard_digital_out[0]", True, "program", 2),
        ("output_int_register[4]", 7, "program", 4),
        ("standard_analog_out[0]", 5.0, "program", 8),
    ]


def test_outputs_that_follow_the_end_of_the_program_have_no_line():
    run = VirtualRobot("CS66").run("""def main():
  set_runstate_standard_digital_output_to_value(0, 3)
end
""")
    assert changes(run) == [
        ("standard_digital_out[0]", True, "program", 2),
        ("standard_digital_out[0]", False, "program", 0),
    ]


def test_a_write_to_the_robots_own_modbus_server_by_the_program_is_the_programs():
    run = VirtualRobot("CS66").run("def main():\n  write_port_register(256, 12)\nend\n")
    assert changes(run) == [("general_register[0]", 12, "program", 2)]


def test_what_a_test_sets_at_a_time_is_the_schedules():
    robot = VirtualRobot("CS66")
    robot.at(0.1, "standard_digital_in[3]", True)
    assert changes(robot.run("def main():\n  sleep(0.2)\nend\n")) == [
        ("standard_digital_in[3]", True, "schedule", 0),
    ]


def test_what_a_test_sets_between_two_ticks_is_a_clients():
    robot = VirtualRobot("CS66")
    run = robot.start("def main():\n  sleep(0.2)\nend\n")
    robot.advance(0.1)
    robot.signals["standard_digital_in[3]"] = True
    robot.advance(0.2)
    assert changes(run) == [("standard_digital_in[3]", True, "client", 0)]


def test_levels_at_the_start_are_no_changes():
    seen = []
    robot = VirtualRobot("CS66", on_event=seen.append)
    robot.set_start({"standard_digital_in[3]": True})
    assert (seen, robot.signals["standard_digital_in[3]"]) == ([], True)
    robot.signals["standard_digital_in[3]"] = False
    assert seen == [SignalChanged(0, "standard_digital_in[3]", False, "client", 0)]


class Button(Device):
    def started(self):
        self.cell.set("standard_digital_in[0]", True, 0.02)


def test_devices_wires_and_schedules_are_told_apart():
    world = World(
        devices=[Button(), Schedule(signal="standard_digital_in[1]", at=[(0.04, True)])],
        wires=[Wire(when="standard_digital_in[1]", then="standard_digital_in[2]")],
    )
    run = VirtualRobot("CS66", world=world).run("def main():\n  sleep(0.1)\nend\n")
    assert changes(run) == [
        ("standard_digital_in[0]", True, "device", 0),
        ("standard_digital_in[1]", True, "schedule", 0),
        ("standard_digital_in[2]", True, "wire", 0),
    ]


class Plc(ModbusClient):
    def opened(self):
        self.write_register(256, 5)


def test_a_device_that_writes_through_a_port_of_the_robot_is_its_client():
    run = VirtualRobot("CS66", world=World(devices=[Plc()])).run("def main():\n  sleep(0.1)\nend\n")
    assert changes(run) == [("general_register[0]", 5, "client", 0)]


def test_a_cause_does_not_outlast_its_request():
    robot = VirtualRobot("CS66")
    robot.at(0.0, "standard_digital_in[3]", True)
    run = robot.run("def main():\n  set_standard_digital_out(1, True)\nend\n")
    assert changes(run) == [
        ("standard_digital_in[3]", True, "schedule", 0),
        ("standard_digital_out[1]", True, "program", 2),
    ]


def test_inputs_of_a_served_robot_say_by_their_origin_what_they_come_from():
    assert [cause_of(origin) for origin in ("rtsi#1", "modbus#2", "ctl#1.1", "dashboard#3", "rtsi#world1")] == [
        "client"
    ] * 5
    assert [cause_of(origin) for origin in ("world:device", "world:wire", "world:schedule", "world:else")] == [
        "device",
        "wire",
        "schedule",
        "client",
    ]
    assert cause_of("restart") == "schedule"
