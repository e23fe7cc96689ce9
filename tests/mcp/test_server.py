"""The server as a client of the protocol's own library sees it; calls about programs go through a real worker."""

import asyncio
import io
import json
import os
import select
import subprocess
import sys

import pytest

pytest.importorskip("mcp.server.mcpserver")

from mcp.client.client import Client
from mcp.client.stdio import StdioServerParameters, stdio_client

from elitescript.mcp.folder import Folder
from elitescript.mcp.requests import UntilReaderGoes, requests
from elitescript.mcp.server import make_server
from elitescript.mcp.workers import Worker

TOOLS = {
    *("programs", "check", "run", "trace", "explain", "commands"),
    *("debug_start", "debug_go", "debug_breakpoints", "debug_evaluate", "debug_history", "debug_end"),
}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "a.script").write_text("def a():\n  textmsg('hello')\nend\n")
    (tmp_path / "bad.script").write_bytes(b"def a():\n  textmsg('\xff')\nend\n")
    return tmp_path


def calls(server, *wanted):
    """Return the answer to each call, as (is error, structured content or text)."""

    async def run():
        async with Client(server) as client:
            answers = [await client.call_tool(name, arguments) for name, arguments in wanted]
        return [(answer.is_error, answer.structured_content or answer.content[0].text) for answer in answers]

    return asyncio.run(run())


def call(folder, name, wall_s=20.0, **arguments):
    return calls(make_server(Folder(folder), wall_s), (name, arguments))[0]


@pytest.mark.parametrize(
    ("text", "state", "codes"),
    [
        ("def f():\n  sleep(0.1)\nend\n", "finished", []),
        (
            "def f():\n  x = get_standard_digital_in(0) == 'on'\n  n = len([])\n  y = 1 / n\nend\n",
            "alarm",
            ["R100", "W240", "W264"],
        ),
        ("def f():\n  x = = 1\nend\n", "does_not_compile", ["E001"]),
    ],
)
def test_clients_get_the_findings_of_text_and_run_first(folder, text, state, codes):
    (is_error, found), (_, traced) = (
        call(folder, "run", text=text),
        call(folder, "trace", text=text, from_s=0.0, to_s=0.1, step_s=0.1),
    )
    assert not is_error
    assert list(found)[:3] == ["findings", "findings_left_out", "why"]
    assert (found["state"], [row["code"] for row in found["findings"]]) == (state, codes)
    assert (traced["findings"], traced["why"]) == (found["findings"], found["why"])


def test_every_tool_describes_itself_and_what_it_returns():
    async def run():
        async with Client(make_server(Folder("."), 1.0)) as client:
            return (await client.list_tools()).tools

    tools = asyncio.run(run())
    assert {tool.name for tool in tools} == TOOLS
    for tool in tools:
        assert tool.description.endswith("."), tool.name
        assert tool.output_schema["properties"], tool.name
        for name, schema in tool.input_schema["properties"].items():
            assert schema["description"], (tool.name, name)


def test_programs_of_the_folder_are_listed(folder):
    is_error, found = call(folder, "programs")
    assert not is_error
    assert found == {"folder": str(folder), "programs": ["a.script", "bad.script"], "programs_left_out": 0}


def test_codes_are_explained(folder):
    is_error, found = call(folder, "explain", code=" w203")
    assert not is_error
    assert (found["code"], found["title"]) == ("W203", "name of a robot command used for something else")
    assert "sleep = 5" in found["text"]


def test_a_command_is_shown_in_full_and_words_find_several(folder):
    (_, one), (_, several) = calls(
        make_server(Folder(folder), 1.0),
        ("commands", {"words": "movej"}),
        ("commands", {"words": "digital output"}),
    )
    assert [parameter["name"] for parameter in one["commands"][0]["parameters"]] == ["q", "a", "v", "t", "r"]
    assert "set_standard_digital_out" in {command["name"] for command in several["commands"]}
    assert "parameters" not in several["commands"][0]


@pytest.mark.parametrize(
    ("name", "arguments", "text"),
    [
        ("check", {}, "one of them"),
        ("check", {"file": "a.script", "text": "x"}, "one of them"),
        ("check", {"file": "../a.script"}, "outside"),
        ("check", {"file": "no.script"}, "no such file"),
        ("check", {"file": "bad.script"}, "line 2, column 12: error E002"),
        ("check", {"text": "x" * 500_001}, "characters"),
        ("run", {"file": "a.script", "world": "cell.json"}, "suffix"),
        ("run", {"file": "a.script", "robot": "../arm.toml"}, "outside"),
        ("run", {"file": 5}, "file"),
        ("explain", {"code": "X1"}, "no code"),
        ("commands", {"words": "wrumpf"}, "no command"),
        ("nothing", {}, "nothing"),
    ],
)
def test_a_call_that_makes_no_sense_is_answered_with_the_reason(folder, name, arguments, text):
    is_error, found = call(folder, name, **arguments)
    assert is_error
    assert text in found


def test_a_program_is_run_and_what_is_wrong_with_a_call_is_said(folder):
    server = make_server(Folder(folder), 20.0)
    (_, found), (is_error, why) = calls(
        server, ("run", {"file": "a.script"}), ("run", {"file": "a.script", "robot": "CS99"})
    )
    assert (found["state"], found["messages"][0]["text"]) == ("finished", "hello")
    assert is_error
    assert "CS99" in why


def test_a_worker_that_does_not_answer_is_ended(folder):
    # One call of Python that takes for ever: no clock of a run can end it.
    is_error, why = call(folder, "run", wall_s=0.2, text="x = 10 ** 10 ** 9\n")
    assert is_error
    assert "was ended" in why


def test_programs_are_debugged_in_processes_of_their_own(folder):
    stop = ("debug_go", {"session": 1, "how": "next"})
    answers = calls(
        make_server(Folder(folder), 20.0),
        ("debug_start", {"file": "a.script"}),
        ("debug_start", {"text": "x = 1\ny = 2\n"}),
        ("debug_go", {"session": 2, "how": "next"}),
        stop,
        ("debug_end", {"session": 1}),
        stop,
    )
    assert [is_error for is_error, _ in answers] == [False, False, False, False, False, True]
    assert [answers[number][1]["session"] for number in (0, 1, 2, 3)] == [1, 2, 2, 1]
    assert (answers[2][1]["stack"][0]["line"], answers[3][1]["reason"]) == (2, "end")
    assert "under way: 2" in answers[5][1]


def test_the_debugged_run_that_was_asked_longest_ago_makes_room(folder, monkeypatch):
    monkeypatch.setattr("elitescript.mcp.debugged.MOST", 1)
    started = [("debug_start", {"text": "x = 1\n"})] * 2
    answers = calls(make_server(Folder(folder), 20.0), *started, ("debug_go", {"session": 1, "how": "next"}))
    assert [is_error for is_error, _ in answers] == [False, False, True]


def test_further_calls_wait_for_those_that_run(folder, monkeypatch):
    under_way, most = [], []

    async def answer(request, wall_s):
        under_way.append(request)
        most.append(len(under_way))
        await asyncio.sleep(0)
        under_way.pop()
        return {"starts": True, "errors": 0, "warnings": 0, "problems": [], "problems_left_out": 0}

    monkeypatch.setattr("elitescript.mcp.server.ask_once", answer)
    monkeypatch.setattr("elitescript.mcp.server.RUNS_MAX", 2)

    async def run():
        async with Client(make_server(Folder(folder), 1.0)) as client:
            await asyncio.gather(*(client.call_tool("check", {"text": "x = 1"}) for _ in range(6)))

    asyncio.run(run())
    assert max(most) == 2
    assert len(most) == 6


def test_no_process_is_left_behind_when_the_server_ends(folder, monkeypatch):
    workers = []

    class Watched(Worker):
        def __init__(self, wall_s):
            super().__init__(wall_s)
            workers.append(self)

    monkeypatch.setattr("elitescript.mcp.debugged.Worker", Watched)
    calls(make_server(Folder(folder), 20.0), ("debug_start", {"file": "a.script"}))
    assert [worker.is_alive for worker in workers] == [False]


def test_the_command_line_serves_standard_input_and_output(folder):
    async def run():
        server = StdioServerParameters(command=sys.executable, args=["-m", "elitescript", "mcp", str(folder)])
        async with Client(stdio_client(server)) as client:
            return await client.call_tool("check", {"text": "movj(1)\n"})

    found = asyncio.run(run()).structured_content
    assert found["problems"][0]["code"] == "E301"
    assert json.dumps(found)


def test_requests_have_texts_with_an_encoding():
    lines = [
        rb'{"id": 1, "text": "\ud83d \\ud83d \ud83d\ude00"}',
        b'{"id": 2, "text": "\xed\xa0\xbd \xc3\xa9"}',
        b"",
        b"x" * 99_999,
    ]
    read = requests(io.BytesIO(b"\n".join(lines))).read().split("\n")
    assert json.loads(read[0])["text"] == r"\ud83d \ud83d 😀"
    assert json.loads(read[1])["text"] == "\ufffd\ufffd\ufffd \xe9"
    assert read[2:] == ["", "x" * 99_999]


@pytest.mark.slow
def test_halves_of_surrogate_pairs_are_answered(folder):
    """In what a client asks, in what a program says, in names of files."""
    name = os.fsdecode(b"b\xe9d.script")
    (folder / name).write_text("def b():\n  textmsg('\\ud83d')\nend\n")
    hello = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "t", "version": "1"}}
    asked = [
        {"method": "initialize", "id": 1, "params": hello},
        {"method": "notifications/initialized"},
        {"method": "tools/call", "id": 2, "params": {"name": "programs", "arguments": {}}},
        {"method": "tools/call", "id": 3, "params": {"name": "run", "arguments": {"text": 'textmsg("\ud83d")\n'}}},
        {"method": "tools/call", "id": 4, "params": {"name": "run", "arguments": {"file": "\ud83d.script"}}},
        {"method": "\ude00", "id": 5, "params": {"x": "\ud83d"}},
    ]
    text = "".join(json.dumps({"jsonrpc": "2.0", **message}) + "\n" for message in asked)

    async def run():
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "elitescript", "mcp", str(folder)),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
        )
        process.stdin.write(text.encode())
        answers = {}
        while len(answers) < 5:
            answer = json.loads(await process.stdout.readline())
            answers[answer["id"]] = answer
        process.stdin.close()
        await process.wait()
        return answers

    answers = asyncio.run(run())
    json.dumps(answers, ensure_ascii=False).encode()
    results = {number: answers[number]["result"]["structuredContent"] for number in (2, 3)}
    assert r"b\udce9d.script" in results[2]["programs"]
    assert results[3]["messages"][0]["text"] == r"\ud83d"
    assert answers[4]["result"]["isError"]
    assert "error" in answers[5]


def test_an_error_is_lines_in_which_nothing_acts(folder):
    is_error, text = call(folder, "run", file="a\x1b[2J\n##[error]b.script")
    assert is_error
    assert "a\\x1b[2J\n| #\\x23[error]b.script: there is no such file" in text


@pytest.mark.skipif(not hasattr(select, "poll"), reason="the system cannot wait for both")
def test_input_ends_with_the_reader_of_the_output():
    (input_, sent), (answers, output) = os.pipe(), os.pipe()
    with io.FileIO(input_) as target, io.BufferedReader(UntilReaderGoes(target, output)) as read:
        os.write(sent, b"one\n")
        assert read.readline() == b"one\n"
        os.close(answers)
        # The input is still open, so that to read it would wait for ever.
        assert read.readline() == b""
    os.close(sent)
    os.close(output)


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(select, "poll"), reason="the system cannot wait for both")
@pytest.mark.parametrize("is_asked", (False, True))
def test_a_client_that_reads_no_more_ends_the_server(is_asked, folder):
    command = [sys.executable, "-P", "-m", "elitescript", "mcp", str(folder)]
    pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    with subprocess.Popen(command, **pipes) as process:
        process.stdout.close()
        if is_asked:
            about = {"protocolVersion": "2025-03-26", "capabilities": {}, "clientInfo": {"name": "a", "version": "1"}}
            request = {"jsonrpc": "2.0", "id": 1, "method": "initialize", "params": about}
            process.stdin.write(json.dumps(request).encode() + b"\n")
            process.stdin.flush()
        try:
            assert (process.wait(60.0), process.stderr.read()) == (0, b"")
        finally:
            process.kill()
