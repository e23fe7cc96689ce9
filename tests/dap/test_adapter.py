"""Debug sessions in memory: the adapter with its engine, request by request."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from elitescript.dap.adapter import Adapter
from elitescript.dap.messages import (
    DOES_NOT_COMPILE,
    IS_RUNNING,
    OUT_OF_ORDER,
    REFUSED,
    UNKNOWN_REQUEST,
    WRONG_ARGUMENTS,
)
from elitescript.dap.requests.catalogue import HANDLERS
from tests.dap.client import Client, Failed, MemoryClient, MemoryRequests

KIT = Path(__file__).with_name("kit")
CELL = KIT / "cell.script"
ALARM = KIT / "alarm.script"


@pytest.fixture
def client():
    found = MemoryClient()
    yield found
    found.request("disconnect")
    found.check_answers()


def program(folder: Path, text: str) -> Path:
    path = folder / "cell.script"
    path.write_text(text)
    return path


def error(client: Client, command: str, **arguments) -> tuple[int, str]:
    with pytest.raises(Failed) as raised:
        client.request(command, **arguments)
    return raised.value.number, raised.value.text


class TestHandshake:
    def test_it_goes_in_the_order_of_the_protocol(self, client):
        capabilities = client.initialize()
        assert capabilities["supportsStepBack"] is True
        assert [one["filter"] for one in capabilities["exceptionBreakpointFilters"]] == ["alarm", "warning"]
        launch = client.launch(CELL)
        assert launch not in client.answers
        client.request("configurationDone")
        client.answer(launch)
        assert client.event("exited")["body"] == {"exitCode": 0}
        client.event("terminated")

    def test_what_comes_out_of_order_is_an_error(self, client):
        assert error(client, "launch", program="x")[0] == OUT_OF_ORDER
        client.initialize()
        assert error(client, "initialize", adapterID="x")[0] == OUT_OF_ORDER
        for command in ("setBreakpoints", "configurationDone", "threads", "continue", "evaluate", "restart", "pause"):
            assert error(client, command)[0] == OUT_OF_ORDER
        client.launch(CELL)
        for command in ("next", "stackTrace", "elitescript/state", "launch"):
            assert error(client, command)[0] == OUT_OF_ORDER
        assert client.stop_of(client.launched)["event"] == "terminated"
        for command in ("stackTrace", "next", "evaluate", "configurationDone"):
            assert error(client, command)[0] == OUT_OF_ORDER

    def test_an_unknown_request_is_an_error_with_the_one_that_was_meant(self, client):
        number, text = error(client, "stackTraces")
        assert number == UNKNOWN_REQUEST
        assert "'stackTrace'" in text

    def test_another_path_format_is_refused(self, client):
        assert error(client, "initialize", adapterID="x", pathFormat="uri")[0] == WRONG_ARGUMENTS

    def test_disconnect_is_possible_at_any_moment(self):
        for count in range(5):
            client = MemoryClient()
            steps = [
                client.initialize,
                lambda client=client: client.launch(CELL),
                lambda client=client: client.set_breakpoints(CELL, 10),
                lambda client=client: client.stop_of(client.launched),
            ]
            for step in steps[:count]:
                step()
            client.request("disconnect")


class TestLaunch:
    def test_a_program_that_does_not_compile_is_an_error_with_places(self, client, tmp_path):
        path = program(tmp_path, "def cell():\n  x = = 1\n  y = (\nend\n")
        client.initialize()
        number, text = error(client, "launch", program=str(path))
        assert number == DOES_NOT_COMPILE
        assert f"{path}: line 2, column 7" in text
        output = client.event("output")["body"]
        assert output["category"] == "stderr"
        assert (output["source"]["path"], output["line"], output["column"]) == (str(path), 2, 7)
        # It can be repaired and launched again.
        path.write_text("def cell():\n  x = 1\nend\n")
        assert client.stop_of(client.launch(path))["event"] == "terminated"

    @pytest.mark.parametrize(
        ("settings", "number", "text"),
        [
            ({"robot": "CS7"}, REFUSED, "CS7"),
            ({"robot": 66}, REFUSED, "launch: robot must be"),
            ({"seed": "x"}, REFUSED, "launch: seed must be a whole number"),
            ({"joints": [1, 2]}, REFUSED, "launch: joints must be six numbers"),
            ({"firmware": "1.0"}, REFUSED, "1.0"),
            ({"network": "a b"}, REFUSED, "launch: network must be"),
            ({"until": -1}, REFUSED, "launch: until must be >= 0 s, got -1"),
            ({"until": "x"}, REFUSED, "launch: until must be a number in s"),
            ({"set": 3}, WRONG_ARGUMENTS, "launch: set must be an object"),
            ({"set": {"standard_digital_inn[3]": True}}, REFUSED, "standard_digital_inn"),
            ({"set": ["count"]}, REFUSED, "launch: set count: write NAME=VALUE"),
            ({"stopOnEntry": 1}, WRONG_ARGUMENTS, "launch: stopOnEntry must be true or false"),
            ({"world": "no.toml"}, REFUSED, "no.toml"),
            ({"program": "no.script"}, REFUSED, "cannot read no.script"),
            ({"program": ""}, WRONG_ARGUMENTS, "launch: program must be"),
        ],
    )
    def test_arguments_that_make_no_sense_are_named(self, client, settings, number, text):
        client.initialize()
        found = error(client, "launch", **{"program": str(CELL), **settings})
        assert found[0] == number
        assert text in found[1]

    def test_what_looks_misspelt_is_said(self, client):
        client.initialize()
        client.launch(CELL, untill=3, __sessionId="x", preLaunchTask="y")
        assert "'untill' is no argument; did you mean 'until'?" in client.launch_outputs

    def test_options_of_the_robot_and_start_values_reach_the_run(self, client, tmp_path):
        path = program(
            tmp_path,
            "def cell():\n  textmsg(parts, get_standard_digital_in(3), get_target_joint_positions()[0])\nend\n",
        )
        joints = [0.5, -1.4, -1.7, -1.6, 1.57, 0]
        client.start(path, set={"parts": 12, "standard_digital_in[3]": True}, joints=joints, robot="CS63")
        texts = "".join(client.texts())
        assert "12True0.5" in texts.replace(" ", "")

    def test_start_values_may_be_texts_as_on_the_command_line(self, client, tmp_path):
        path = program(tmp_path, "def cell():\n  textmsg(parts)\nend\n")
        client.start(path, set=["parts=7"])
        assert "7\n" in client.texts()

    def test_the_time_limit_ends_the_run_with_its_exit_code(self, client):
        client.start(CELL, until=0.5)
        assert client.bodies("exited") == [{"exitCode": 4}]

    def test_an_alarm_without_a_filter_ends_the_run_with_its_exit_code(self, client):
        assert client.start(ALARM)["event"] == "terminated"
        assert client.bodies("exited") == [{"exitCode": 1}]
        alarms = [one for one in client.bodies("output") if one["category"] == "stderr"]
        assert [one["line"] for one in alarms] == [3]

    def test_without_debugging_nothing_stops(self, client):
        client.initialize()
        client.launch(CELL, noDebug=True, stopOnEntry=True, stopOnEnd=True)
        client.set_breakpoints(CELL, 10)
        assert client.stop_of(client.launched)["event"] == "terminated"


class TestStops:
    def test_on_entry(self, client):
        stop = client.start(CELL, stopOnEntry=True)
        assert stop["body"]["reason"] == "entry"
        assert stop["body"]["allThreadsStopped"] is True
        assert client.line(stop["body"]["threadId"]) == 3

    def test_on_end_if_asked_for_and_going_back_from_there(self, client):
        stop = client.start(CELL, stopOnEnd=True)
        assert stop["body"]["reason"] == "end"
        assert client.go("stepBack")["body"]["reason"] == "step"
        assert client.line() == 14
        assert client.go("continue")["body"]["reason"] == "end"

    def test_at_a_breakpoint_that_it_names(self, client):
        client.initialize()
        launch = client.launch(CELL)
        first, second = client.set_breakpoints(CELL, 2, 12)
        assert (first["verified"], first["line"]) == (True, 3)
        assert (second["verified"], second["line"]) == (True, 12)
        assert client.stop_of(launch)["body"]["hitBreakpointIds"] == [first["id"]]
        assert client.go("continue")["body"]["hitBreakpointIds"] == [second["id"]]
        assert client.line() == 12

    def test_breakpoints_keep_their_numbers_when_others_come(self, client):
        client.initialize()
        client.launch(CELL)
        (one,) = client.set_breakpoints(CELL, 12)
        other, same = client.set_breakpoints(CELL, 10, 12)
        assert same["id"] == one["id"] != other["id"]

    def test_a_breakpoint_behind_the_text_and_one_of_another_file_are_not_verified(self, client):
        client.initialize()
        client.launch(CELL)
        (behind,) = client.set_breakpoints(CELL, 99)
        assert not behind["verified"]
        assert behind["message"]
        client.set_breakpoints(CELL, 12)
        (other,) = client.set_breakpoints(ALARM, 2)
        assert not other["verified"]
        assert client.stop_of(client.launched)["event"] == "stopped"

    def test_the_older_form_of_breakpoints_is_read(self, client):
        client.initialize()
        client.launch(CELL)
        found = client.request("setBreakpoints", source={"path": str(CELL)}, lines=[12])
        assert [one["line"] for one in found["breakpoints"]] == [12]

    def test_with_a_condition_a_count_or_a_message(self, client):
        client.start(CELL, {"line": 12, "condition": "count == 1"})
        assert client.evaluate("count") == "1"
        client.set_breakpoints(CELL, {"line": 10, "logMessage": "count is {count}"})
        assert client.go("continue")["event"] == "terminated"
        logs = [one["output"] for one in client.bodies("output") if "count is" in one["output"]]
        assert logs == ["count is 2\n"]

    def test_the_hit_count(self, client):
        client.start(CELL, {"line": 12, "hitCondition": "2"})
        assert client.evaluate("count") == "1"

    def test_at_a_function_and_at_a_command(self, client):
        client.initialize()
        launch = client.launch(CELL)
        items = [{"name": "pick"}, {"name": "movej"}, {"name": "no_such_name"}]
        states = client.request("setFunctionBreakpoints", breakpoints=items)["breakpoints"]
        assert [one["verified"] for one in states] == [True, True, False]
        stop = client.stop_of(launch)
        assert (stop["body"]["reason"], client.line()) == ("function breakpoint", 10)
        assert stop["body"]["hitBreakpointIds"] == [states[1]["id"]]
        client.go("continue")
        assert client.line() == 5

    def test_at_a_change_of_a_signal_and_of_a_global(self, client):
        client.initialize()
        launch = client.launch(CELL)
        items = [{"dataId": "standard_digital_out[3]"}, {"dataId": "count"}]
        states = client.request("setDataBreakpoints", breakpoints=items)["breakpoints"]
        assert [one["verified"] for one in states] == [True, True]
        seen, told = [], []
        stop = client.stop_of(launch)
        while stop["event"] == "stopped":
            assert stop["body"]["reason"] == "data breakpoint"
            told.append(stop["body"]["description"])
            seen.append(stop["body"]["hitBreakpointIds"])
            stop = client.go("continue")
        output, count = ([one["id"]] for one in states)
        assert seen == [count, output, count, count, count]
        assert told[:3] == ["count: not there -> 0", "standard_digital_out[3]: False -> True", "count: 0 -> 1"]

    def test_at_an_alarm_before_it_unwinds(self, client):
        stop = client.start(ALARM, filters=("alarm",))
        assert stop["body"]["reason"] == "exception"
        assert client.line() == 3
        info = client.request("exceptionInfo", threadId=1)
        assert info["breakMode"] == "unhandled"
        assert "index" in info["description"]
        assert stop["body"]["description"] == f"alarm {info['exceptionId']}"
        assert stop["body"]["text"] == info["details"]["message"]
        assert client.variables(client.scopes()["Locals"]).get("parts", "[1, 2]") == "[1, 2]"
        assert client.go("continue")["event"] == "terminated"
        assert client.bodies("exited") == [{"exitCode": 1}]

    def test_a_warning_stops_wherever_it_comes_up(self, client, tmp_path):
        moves = ("movej([0, -1.57, -1.57, -1.57, 1.57, 0], r=0.5)", "movej([0.1, -1.57, -1.57, -1.57, 1.57, 0])")
        text = f"def cell():\n  {moves[0]}\n  {moves[1]}\nend\n"
        stop = client.start(program(tmp_path, text), filters=("alarm", "warning"))
        assert stop["body"]["reason"] == "exception"
        info = client.request("exceptionInfo", threadId=1)
        assert (info["exceptionId"], info["breakMode"]) == ("W235", "always")

    def test_there_is_no_exception_to_ask_for_elsewhere(self, client):
        client.start(CELL, stopOnEntry=True)
        assert error(client, "exceptionInfo", threadId=1)[0] == REFUSED

    def test_an_unknown_filter_is_refused(self, client):
        client.initialize()
        client.launch(CELL)
        number, text = error(client, "setExceptionBreakpoints", filters=["alarms"])
        assert number == WRONG_ARGUMENTS
        assert "'alarm'" in text

    def test_places_of_breakpoints_are_the_statements(self, client):
        client.initialize()
        client.launch(CELL)
        found = client.request("breakpointLocations", source={"path": str(CELL)}, line=9, endLine=11)["breakpoints"]
        assert [one["line"] for one in found] == [9, 10, 11]


class TestGoing:
    def test_steps(self, client):
        client.start(CELL, 10)
        assert client.go("next")["body"]["reason"] == "step"
        assert client.line() == 11
        client.go("stepIn")
        assert client.line() == 5
        assert client.stack()[0]["name"] == "pick"
        client.go("stepOut")
        assert client.line() in (11, 12)
        client.set_breakpoints(CELL)
        client.go("stepBack")
        assert client.line() in (10, 11)
        assert client.go("reverseContinue")["body"]["reason"] == "entry"
        assert client.line() == 3

    def test_into_one_of_several_calls(self, client, tmp_path):
        functions = "  def f(x):\n    return x + 1\n  end\n  def g(x):\n    return x * 2\n  end\n"
        client.start(program(tmp_path, f"def cell():\n{functions}  y = g(f(3))\n  z = y\nend\n"), 8)
        targets = client.request("stepInTargets", frameId=client.stack()[0]["id"])["targets"]
        assert [one["label"] for one in targets] == ["g()", "f()"]
        stop = client.go("stepIn", targetId=targets[0]["id"])
        assert stop["body"]["reason"] == "step"
        assert client.line() == 6
        assert "hitBreakpointIds" not in stop["body"]
        assert error(client, "stepIn", threadId=1, targetId=targets[0]["id"])[0] == WRONG_ARGUMENTS

    def test_wrong_threads_and_arguments_are_refused(self, client):
        client.start(CELL, stopOnEntry=True)
        for command in ("next", "continue", "stepBack", "reverseContinue", "stackTrace"):
            assert error(client, command, threadId=77)[0] == REFUSED
        assert error(client, "next")[0] == WRONG_ARGUMENTS
        assert error(client, "next", threadId=1, granularity="word")[0] == WRONG_ARGUMENTS
        assert client.line() == 3

    def test_to_earlier_and_later_moments_of_a_line(self, client):
        client.start(CELL, {"line": 12, "condition": "count == 2"})
        targets = client.request("gotoTargets", source={"path": str(CELL)}, line=10)["targets"]
        assert len(targets) == 3
        assert all(one["label"].startswith("back to") for one in targets)
        stop = client.go("goto", targetId=targets[0]["id"])
        assert stop["body"]["reason"] == "goto"
        assert (client.line(), client.evaluate("count")) == (10, "0")
        assert error(client, "goto", threadId=1, targetId=99)[0] == WRONG_ARGUMENTS

    def test_to_a_tick_a_time_and_a_statement(self, client):
        client.start(CELL, 11)
        here = client.moment()
        now = client.request("elitescript/state")
        client.go("elitescript/goto", tick=now["tick"] // 2)
        assert client.request("elitescript/state")["tick"] == now["tick"] // 2
        client.go("elitescript/goto", t=0.1)
        assert client.request("elitescript/state")["t"] == pytest.approx(0.1)
        client.go("elitescript/goto", statement=1)
        assert client.line() == 3
        client.go("continue")
        assert client.moment() == here
        for arguments in ({}, {"tick": 1, "t": 1.0}, {"t": -1.0}, {"statement": 0}, {"tick": "x"}):
            assert error(client, "elitescript/goto", **arguments)[0] == WRONG_ARGUMENTS

    def test_to_the_last_time_that_a_line_ran(self, client):
        client.start(CELL, 11)
        client.go("continue")
        stop = client.go("elitescript/lastPass", source={"path": str(CELL)}, line=10)
        assert (client.line(), client.evaluate("count")) == (10, "1")
        assert stop["body"]["reason"] == "goto"
        there = client.moment()
        client.go("elitescript/lastPass", source={"path": str(CELL)}, line=1000)
        assert client.moment() == there
        assert "line 1000 has not run before" in client.texts()[-1]

    def test_changes_of_a_local_are_those_of_the_function_of_a_frame(self, client, tmp_path):
        path = tmp_path / "job.script"
        path.write_text(
            "def job():\n  n = 1\n  def half(n):\n    n = n * 0.5\n    return n\n  end\n  half(8)\n  n = 2\nend\n"
        )
        client.start(path, 5)
        inner, outer = client.stack()
        changes = [
            [(one["old"], one["new"]) for one in client.request("elitescript/history", name="n", **of)["changes"]]
            for of in ({"frameId": inner["id"]}, {"frameId": outer["id"]}, {"function": "half"})
        ]
        assert changes == [[("", "8"), ("8", "4.0")], [("", "1")], [("", "8"), ("8", "4.0")]]

    def test_the_same_moment_shows_the_same_from_either_side(self, client):
        client.start(CELL, stopOnEntry=True)
        moments = [client.moment()]
        for _ in range(12):
            client.go("stepIn")
            moments.append(client.moment())
        client.go("elitescript/goto", statement=1)
        assert client.moment() == moments[0]

    def test_to_where_it_was_paused(self, client):
        client.start(CELL, stopOnEntry=True)
        with client.meanwhile():
            client.send("pause", threadId=1)
        assert client.go("continue")["body"]["reason"] == "pause"
        statement = client.adapter.session.stop.position.statement
        client.go("elitescript/goto", statement=statement)
        assert client.adapter.session.stop.position.statement == statement

    def test_restart_is_the_same_run_with_the_same_breakpoints(self, client):
        client.start(CELL, 11)
        first = client.moment()
        client.go("continue")
        stop = client.go("restart")
        assert stop["body"]["reason"] == "breakpoint"
        assert client.moment() == first

    def test_restart_takes_the_new_text_and_new_arguments(self, client, tmp_path):
        path = program(tmp_path, "def cell():\n  x = 1\n  y = x\nend\n")
        client.start(path, 3)
        path.write_text("def cell():\n  x = 2\n  y = x\nend\n")
        client.go("restart")
        assert client.evaluate("x") == "2"
        path.write_text("def cell(:\n")
        assert error(client, "restart")[0] == DOES_NOT_COMPILE
        assert client.evaluate("x") == "2"
        path.write_text("def cell():\n  x = 3\n  y = x\nend\n")
        assert client.go("restart", arguments={"program": str(path), "stopOnEntry": True})["body"]["reason"] == "entry"
        client.go("continue")
        assert client.evaluate("x") == "3"


class TestLooking:
    def test_scopes_and_variables(self, client):
        client.start(CELL, 6)
        scopes = client.scopes()
        assert list(scopes) == ["Locals", "Globals", "Robot"]
        assert client.variables(scopes["Locals"]) == {"depth": "0", "below": "0.01"}
        assert client.variables(scopes["Globals"])["count"] == "0"
        robot = client.variables(scopes["Robot"])
        assert any("joint" in name for name in robot)

    def test_variables_come_in_pages(self, client, tmp_path):
        client.start(program(tmp_path, "def cell():\n  a = list(range(1000))\n  b = 1\nend\n"), 3)
        (found,) = [
            one
            for reference in client.scopes().values()
            for one in client.request("variables", variablesReference=reference)["variables"]
            if one["name"] == "a"
        ]
        assert found["indexedVariables"] == 1000
        page = client.request(
            "variables", variablesReference=found["variablesReference"], filter="indexed", start=500, count=3
        )
        assert [one["value"] for one in page["variables"]] == ["500", "501", "502"]
        assert error(client, "variables", variablesReference=found["variablesReference"], filter="x")[0]
        assert error(client, "variables", variablesReference=99999)[0] == REFUSED
        assert error(client, "variables", variablesReference=0)[0] == WRONG_ARGUMENTS

    def test_stacks_come_in_pages(self, client, tmp_path):
        text = "def cell():\n  def f(n):\n    if n > 0:\n      f(n - 1)\n    end\n    n = 0\n  end\n  f(30)\nend\n"
        client.start(program(tmp_path, text), 6)
        whole = client.request("stackTrace", threadId=1)
        assert whole["totalFrames"] == len(whole["stackFrames"]) >= 31
        part = client.request("stackTrace", threadId=1, startFrame=5, levels=2)
        assert part["totalFrames"] == whole["totalFrames"]
        assert [one["line"] for one in part["stackFrames"]] == [4, 4]

    def test_lines_and_columns_are_counted_as_the_client_does(self, client):
        client.initialize(linesStartAt1=False, columnsStartAt1=False)
        launch = client.launch(CELL)
        (found,) = client.set_breakpoints(CELL, 11)
        assert (found["line"], found["column"]) == (11, 4)
        client.stop_of(launch)
        assert client.stack()[0]["line"] == 11
        assert client.stack()[0]["column"] == 4

    def test_types_are_said_to_clients_that_show_them(self, client):
        client.initialize(supportsVariableType=True)
        launch = client.launch(CELL)
        client.set_breakpoints(CELL, 12)
        client.stop_of(launch)
        frame = client.stack()[0]["id"]
        assert client.request("evaluate", expression="count", frameId=frame)["type"] == "int"

    def test_threads_and_what_they_wait_for(self, client, tmp_path):
        text = (
            "def cell():\n  def watch():\n    while True:\n      sleep(0.5)\n    end\n  end\n"
            "  start_thread(watch, ())\n  sleep(1.0)\n  x = 1\nend\n"
        )
        client.start(program(tmp_path, text), 9)
        threads = client.request("threads")["threads"]
        assert len(threads) == 2
        assert threads[0]["name"] == "main"
        other = client.stack(threads[1]["id"])
        assert other[0]["line"] in (3, 4)
        assert {"reason": "started", "threadId": threads[1]["id"]} in client.bodies("thread")

    def test_a_step_of_another_thread_than_the_stopped_one_lets_both_go_on(self, client, tmp_path):
        text = (
            "def cell():\n  def watch():\n    while True:\n      sleep(0.5)\n    end\n  end\n"
            "  start_thread(watch, ())\n  sleep(1.0)\n  x = [][0]\nend\n"
        )
        stop = client.start(program(tmp_path, text), filters=("alarm",))
        other = client.request("threads")["threads"][1]["id"]
        assert (stop["body"]["reason"], stop["body"]["threadId"]) == ("exception", 1)
        client.go("stepBack", 1)
        assert client.bodies("continued") == []
        client.go("continue", other)
        assert client.bodies("continued") == []
        # A client that hears nothing takes the exception for that of the main thread still.
        stop = client.go("stepBack", other)
        assert stop["body"]["threadId"] == other
        assert client.bodies("continued") == [{"threadId": 1, "allThreadsContinued": True}]
        names = [one["event"] for one in client.all_events]
        assert names.index("continued") < len(names) - 1 - names[::-1].index("stopped")
        client.go("stepBack", other)
        assert len(client.bodies("continued")) == 1
        client.go("elitescript/goto", t=0.0)
        assert client.bodies("continued")[1:] == [{"threadId": other, "allThreadsContinued": True}]

    def test_evaluate_without_effects_and_with_them(self, client):
        client.start(CELL, 12)
        assert client.evaluate("count + 1") == "1"
        for context in ("watch", "hover", "clipboard"):
            frame = client.stack()[0]["id"]
            arguments = {"expression": "set_standard_digital_out(1, True)", "frameId": frame, "context": context}
            assert error(client, "evaluate", **arguments)[0] == REFUSED
        assert error(client, "evaluate", expression="no_such", frameId=client.stack()[0]["id"])[0] == REFUSED
        client.evaluate("count = 2", "repl")
        assert client.evaluate("count") == "2"
        client.set_breakpoints(CELL)
        client.go("continue")
        assert "count 3\n" in client.texts()

    def test_what_is_set_stays_on_the_way_back_and_forth(self, client):
        client.initialize(supportsInvalidatedEvent=True)
        launch = client.launch(CELL)
        client.set_breakpoints(CELL, 12)
        client.stop_of(launch)
        found = client.request("setVariable", variablesReference=client.scopes()["Globals"], name="count", value="1")
        assert found["value"] == "1"
        assert client.bodies("invalidated")[-1] == {"areas": ["variables"]}
        frame = client.stack()[0]["id"]
        assert client.request("setExpression", expression="found", value="5.5", frameId=frame)["value"] == "5.5"
        client.go("stepBack")
        assert client.evaluate("count") == "0"
        client.go("next")
        assert client.evaluate("count") == "1"
        assert client.evaluate("found") == "5.5"

    def test_completions_in_the_console(self, client):
        client.start(CELL, 12)
        frame = client.stack()[0]["id"]

        def offers(text, line=1, column=0):
            where = {"line": line, "column": column or len(text) + 1, "frameId": frame}
            return client.request("completions", text=text, **where)["targets"]

        def kinds(targets):
            return [(one["label"], one["type"], one["length"]) for one in targets]

        found = offers("x = mov")
        assert ("movej", "function", 3) in kinds(found)
        assert "movej" not in [label for label, _, _ in kinds(offers("textmsg(mo.mov"))]
        assert kinds(offers("cou"))[0] == ("count", "variable", 3)
        assert kinds(offers("tc"))[0] == ("tcp", "value", 2)
        assert ("standard_digital_in", "value", 4) in kinds(offers("x = stan"))
        assert kinds(offers("movej([1], "))[:2] == [("a=", "property", 0), ("v=", "property", 0)]
        assert ("count", "variable", 1) in kinds(offers("movej([1], v=c"))
        assert kinds(offers("# cou")) == kinds(offers('"cou')) == []
        # A column behind the text, in the last line of several.
        assert kinds(offers("x = 1\ncou", line=2, column=99))[0] == ("count", "variable", 3)
        assert [one["sortText"] for one in offers("")[:2]] == ["000", "001"]

    def test_texts(self, client):
        client.start(CELL, stopOnEntry=True)
        shown = {"name": "cell.script", "path": str(CELL)}
        assert client.request("loadedSources") == {"sources": [shown]}
        assert client.request("source", source=shown, sourceReference=0)["content"] == CELL.read_text()
        assert error(client, "source", sourceReference=9)[0] == REFUSED

    def test_the_state_of_the_moment(self, client):
        client.start(CELL, 11)
        state = client.request("elitescript/state")
        assert state["t"] == pytest.approx(state["tick"] * 0.004)
        assert state["joints"] == pytest.approx([0.0, -1.4, -1.7, -1.6, 1.57, 0.0])
        assert len(state["tcp_pose"]) == 6

    def test_the_changes_of_a_name_and_of_a_signal(self, client):
        client.start(CELL, 14)
        changes = client.request("elitescript/history", name="count")["changes"]
        assert [one["new"] for one in changes] == ["0", "1", "2", "3"]
        assert [one["line"] for one in changes] == [3, 12, 12, 12]
        (found,) = client.request("elitescript/history", name="standard_digital_out[3]")["changes"]
        assert (found["line"], found["thread"], found["source"]["path"]) == (6, "main", str(CELL))

    def test_data_breakpoints_are_offered_for_names_and_signals(self, client):
        client.start(CELL, 12)
        found = client.request("dataBreakpointInfo", name="standard_digital_out[3]")
        assert found["dataId"] == "standard_digital_out[3]"
        assert found["accessTypes"] == ["write"]
        found = client.request("dataBreakpointInfo", name="count", variablesReference=client.scopes()["Globals"])
        assert found["dataId"] == "count"
        assert client.request("dataBreakpointInfo", name="3 +")["dataId"] is None


class TestWhileItRuns:
    """Requests that have arrived when the program begins to run: they are seen before its first statement."""

    def test_pause_stops_it(self, client):
        client.start(CELL, stopOnEntry=True)
        with client.meanwhile():
            client.send("pause", threadId=1)
        assert client.go("continue")["body"]["reason"] == "pause"

    def test_what_needs_a_stop_is_refused_with_the_word_of_the_protocol(self, client):
        client.start(CELL, stopOnEntry=True)
        with client.meanwhile():
            seq = client.send("stackTrace", threadId=1)
            threads = client.send("threads")
        client.go("continue")
        with pytest.raises(Failed) as raised:
            client.answer(seq)
        assert raised.value.number == IS_RUNNING
        assert raised.value.response["message"] == "notStopped"
        assert client.answer(threads)["threads"] == [{"id": 1, "name": "main"}]

    def test_breakpoints_are_set_and_it_goes_on(self, client):
        client.start(CELL, stopOnEntry=True)
        with client.meanwhile():
            client.send(
                "setBreakpoints", source={"path": str(CELL)}, breakpoints=[{"line": 12, "condition": "count == 2"}]
            )
        assert client.go("continue")["body"]["reason"] == "breakpoint"
        assert client.line() == 12

    @pytest.mark.parametrize("command", ["next", "stepIn", "stepOut"])
    def test_a_step_that_is_interrupted_for_a_request_ends_where_it_would(self, client, command):
        places = []
        for is_interrupted in (False, True):
            other = MemoryClient()
            other.start(CELL, 11)
            other.set_breakpoints(CELL)
            if command == "stepOut":
                other.go("stepIn")
            if is_interrupted:
                with other.meanwhile():
                    other.send("setExceptionBreakpoints", filters=[])
            other.go(command)
            places.append(other.moment())
        assert places[0] == places[1]

    @pytest.mark.parametrize("command", ["terminate", "disconnect", "restart"])
    def test_the_session_can_be_ended_and_begun_again(self, client, command):
        client.start(CELL, stopOnEntry=True)
        with client.meanwhile():
            seq = client.send(command)
        client.send("continue", threadId=1)
        client.answer(seq)
        if command == "terminate":
            assert client.event("exited")["body"] == {"exitCode": 0}
            client.event("terminated")
        elif command == "restart":
            assert client.stop()["body"]["reason"] == "entry"


def test_no_message_is_left_behind_wherever_another_one_interrupts_its_sending():
    """A signal handler may send in the middle of `send`; nothing that comes later would send what it left."""
    interrupted = 0
    for line in range(20):
        sent: list[object] = []
        adapter = Adapter(sent.append, MemoryRequests(), HANDLERS)
        left = [line]

        def trace(frame, event, _, adapter=adapter, left=left):
            if frame.f_code is not Adapter.send.__code__:
                return None
            if event == "line" and left:
                left[0] -= 1
                if left[0] < 0:
                    left.clear()
                    sys.settrace(None)
                    adapter.send({"number": 2})
            return trace

        before = sys.gettrace()
        sys.settrace(trace)
        try:
            adapter.send({"number": 1})
        finally:
            sys.settrace(before)
        interrupted += not left
        assert len(sent) == 2 - bool(left), line
    assert 5 <= interrupted < 20


def test_no_text_of_a_program_acts_in_the_console(client, tmp_path):
    text = r"a\n::error::b ##[c] \x1b[2J \ud83d"
    said = f'  textmsg("{text}")\n  popup("{text}", "{text}", False, False)\n  raise ValueError("{text}")\n'
    client.initialize()
    client.stop_of(client.launch(program(tmp_path, f"def cell():\n{said}end\n")))
    shown = "a\n| :\\x3aerror::b #\\x23[c] \\x1b[2J \\ud83d\n"
    assert [one for one in client.texts() if "error" in one] == [
        shown,
        f"{shown[:-1]}: {shown}",
        f"R100 ValueError: {shown}",
    ]


def test_the_end_counts_what_was_found(client, tmp_path):
    client.initialize()
    lines = "  movej([0, -1.57, -1.57, -1.57, 1.57, 0], v=60, a=80)\n  speedj([0.3, 0, 0, 0, 0, 0], 1.0, 0.5)\n"
    client.stop_of(client.launch(program(tmp_path, f"def cell():\n{lines}end\n")))
    assert client.texts()[-1].endswith(", 4 warnings\n")


class TestConditions:
    """What cannot be evaluated: what the client is told; see tests/debugger/test_conditions.py."""

    TEXT = "def cell():\n  x = 1\n  for i in range(3):\n    x = x + i\n  end\nend\n"

    def test_it_stops_once_and_says_why(self, client, tmp_path):
        path = program(tmp_path, self.TEXT)
        stop = client.start(path, {"line": 4, "condition": "xx > 1"})["body"]
        assert (stop["reason"], stop["hitBreakpointIds"]) == ("breakpoint", [1])
        why = "there is no variable 'xx' here; did you mean 'x'?"
        text = f"the condition of line 4 cannot be evaluated: xx > 1: {why} (said once)"
        assert (stop["description"], stop["text"]) == ("a condition that cannot be evaluated", text)
        (output,) = [body for body in client.bodies("output") if text in body["output"]]
        assert (output["category"], output["line"], output["source"]["path"]) == ("important", 4, str(path))
        assert client.go("continue")["event"] == "terminated"
        assert len([one for one in client.texts() if text in one]) == 1

    def test_it_does_again_after_a_restart_and_when_it_is_set_again(self, client, tmp_path):
        path = program(tmp_path, self.TEXT)
        client.start(path, {"line": 4, "condition": "1 / 0"})
        assert client.go("restart")["body"]["reason"] == "breakpoint"
        client.set_breakpoints(path, {"line": 4, "condition": "1 / 0"})
        assert client.go("continue")["body"]["reason"] == "breakpoint"
        assert client.go("continue")["event"] == "terminated"

    def test_a_number_of_hits_that_cannot_come_is_refused(self, client, tmp_path):
        path = program(tmp_path, self.TEXT)
        client.initialize()
        seq = client.launch(path)
        (body,) = client.set_breakpoints(path, {"line": 4, "hitCondition": "0"})
        assert (body["verified"], body["message"]) == (
            False,
            "'0' is no number of hits that can come: they count from 1",
        )
        assert client.stop_of(seq)["event"] == "terminated"

    def test_filters_have_no_condition(self, client):
        client.initialize()
        client.launch(CELL)
        wrong = [{"filterId": "alarm", "condition": "x > 1"}]
        assert error(client, "setExceptionBreakpoints", filters=[], filterOptions=wrong)[0] == WRONG_ARGUMENTS


class TestLargeValues:
    TEXT = (
        "def cell():\n  v = list(range(100000))\n  d = {}\n  for i in range(1000):\n    d[str(i)] = i\n  end\n"
        "  t = [1]\n  sleep(0.1)\nend\n"
    )

    def test_what_is_left_out_is_counted_and_comes_in_pages(self, client, tmp_path):
        client.start(program(tmp_path, self.TEXT), 8)
        reference = client.scopes()["Locals"]
        rows = {one["name"]: one for one in client.request("variables", variablesReference=reference)["variables"]}
        for name, count in (("v", 100_000), ("d", 1000)):
            assert rows[name]["value"].endswith(f"… {count - 100:,} more" + ("]" if name == "v" else "}"))
            assert (rows[name]["namedVariables"], rows[name]["indexedVariables"]) == (0, count)
            held = rows[name]["variablesReference"]
            *some, more = client.request("variables", variablesReference=held)["variables"]
            assert (len(some), more["value"], more["variablesReference"]) == (100, f"… {count - 100:,} more", 0)
            page = client.request("variables", variablesReference=held, filter="indexed", start=count - 2, count=100)
            assert len(page["variables"]) == 2
            found = client.request("evaluate", expression=name, context="hover", frameId=client.stack()[0]["id"])
            assert found["result"] == rows[name]["value"]

    def test_one_that_is_not_shown_can_be_set(self, client, tmp_path):
        client.start(program(tmp_path, self.TEXT), 8)
        reference = client.scopes()["Locals"]
        rows = {one["name"]: one for one in client.request("variables", variablesReference=reference)["variables"]}
        for name, child, expression in (("v", "[99999]", "v[99999]"), ("d", "'999'", "d['999']")):
            held = rows[name]["variablesReference"]
            assert client.request("setVariable", variablesReference=held, name=child, value="-1")["value"] == "-1"
            assert client.evaluate(expression) == "-1"

    def test_values_of_the_robot_are_not_variables_of_their_names(self, client, tmp_path):
        client.start(program(tmp_path, self.TEXT), 8)
        scopes = client.scopes()
        number, text = error(client, "setVariable", variablesReference=scopes["Robot"], name="t", value="5")
        assert number == REFUSED and "cannot be named" in text
        number, text = error(client, "setVariable", variablesReference=scopes["Robot"], name="tick", value="5")
        assert number == REFUSED and "cannot be set" in text
        assert client.evaluate("t") == "[1]"
        reference = client.request("variables", variablesReference=scopes["Locals"])["variables"]
        held = next(one["variablesReference"] for one in reference if one["name"] == "t")
        assert client.request("setVariable", variablesReference=held, name="[0]", value="7")["value"] == "7"


@pytest.mark.parametrize("way", ["link.script", "folder/a b.script", "uri", "./a b.script", "folder/link.script"])
def test_a_program_is_found_by_each_of_its_names(client, tmp_path, way):
    path = tmp_path / "a b.script"
    path.write_text("def cell():\n  x = 1\n  y = 2\nend\n")
    (tmp_path / "link.script").symlink_to(path)
    (tmp_path / "folder").symlink_to(tmp_path)
    name = path.as_uri() if way == "uri" else f"{tmp_path}/{way}"
    client.initialize()
    seq = client.launch(path)
    (body,) = client.set_breakpoints(name, 3)
    assert body["verified"]
    assert client.stop_of(seq)["body"]["reason"] == "breakpoint"
    client.request("restart", arguments={"program": name})
    assert client.stop()["body"]["reason"] == "breakpoint"


def test_a_step_into_a_target_does_not_set_other_breakpoints_again(client, tmp_path):
    text = "def cell():\n  def f(k):\n    return k\n  end\n  for i in range(3):\n    x = f(i)\n  end\nend\n"
    client.initialize()
    seq = client.launch(program(tmp_path, text))
    client.request("setFunctionBreakpoints", breakpoints=[{"name": "f", "condition": "kk > 1"}])
    assert "'kk'" in client.stop_of(seq)["body"]["text"]
    for _ in range(2):
        while client.line() != 6:
            client.go("next")
        target = client.request("stepInTargets", frameId=client.stack()[0]["id"])["targets"][0]["id"]
        stop = client.go("stepIn", targetId=target)["body"]
        assert (stop["reason"], client.line()) == ("step", 3)
