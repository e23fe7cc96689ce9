"""What tools refuse: what the command line refuses, in the same words, and arguments that they do not have.

The rows are made of the tools' own schemas, so that a new tool or argument is in them.
"""

from __future__ import annotations

import asyncio
import json
from typing import Any

import pytest

pytest.importorskip("mcp.server.mcpserver")

from mcp.client.client import Client

from elitescript.cli.main import main
from elitescript.mcp.folder import Folder
from elitescript.mcp.server import make_server
from elitescript.mcp.worker import answer_to, requests

PROGRAM = "def a():\n  global parts\n  parts = 1\n  sleep(0.1)\nend\n"

WRONG: dict[str, tuple[Any, ...]] = {
    "string": (3, True, ["x"], {"a": 1}),
    "integer": ("3", True, 1.5, [1]),
    "number": ("1.5", True, [1.0]),
    "boolean": ("yes", 1, "true"),
    "array": (3, {"a": 1}, "x"),
    "object": (3, [1]),
}
"""Values that are not of a type of JSON."""


SERVER = make_server(Folder("."), 1.0)
"""One for all tests: making it takes longer than a call."""


def tools() -> dict[str, dict[str, Any]]:
    async def run() -> dict[str, dict[str, Any]]:
        async with Client(SERVER) as client:
            return {tool.name: tool.input_schema for tool in (await client.list_tools()).tools}

    return asyncio.run(run())


TOOLS = tools()


def answers(*wanted: tuple[str, dict[str, Any]]) -> list[str]:
    """Return what each call is refused with; `done` for one that is not."""

    async def run() -> list[str]:
        async with Client(SERVER) as client:
            found = [await client.call_tool(name, arguments) for name, arguments in wanted]
        return [answer.content[0].text if answer.is_error else "done" for answer in found]

    return asyncio.run(run())


def types(schema: dict[str, Any]) -> set[str]:
    rows = schema.get("anyOf", [schema])
    return {row["type"] for row in rows if row.get("type") != "null"}


def fitting(schema: dict[str, Any]) -> Any:
    """Return a value that an argument takes by its type alone."""
    if "enum" in schema:
        return schema["enum"][0]
    return {"string": "x", "integer": 1, "number": 0.1, "boolean": False, "array": [], "object": {}}[
        sorted(types(schema))[0]
    ]


@pytest.mark.parametrize("name", TOOLS)
def test_an_argument_that_a_tool_does_not_have_is_refused(name: str) -> None:
    schema = TOOLS[name]
    assert schema["additionalProperties"] is False
    needed = {key: fitting(schema["properties"][key]) for key in schema.get("required", ())}
    near = {f"{key}x": key for key in schema["properties"]}
    wrong = [*near, "until", "timeout", ""]
    found = answers(*((name, {**needed, key: 1}) for key in wrong if key not in schema["properties"]))
    for key, text in zip(wrong, found, strict=True):
        assert f"{name} takes" in text and repr(key) in text, (key, text)
        if key in near:
            assert "did you mean" in text


@pytest.mark.parametrize("name", TOOLS)
def test_values_of_another_type_are_refused_with_the_argument(name: str) -> None:
    schema = TOOLS[name]
    needed = {key: fitting(schema["properties"][key]) for key in schema.get("required", ())}
    rows = [
        (key, value)
        for key, row in schema["properties"].items()
        for value in WRONG["string" if "enum" in row else sorted(types(row))[0]]
    ]
    found = answers(*((name, {**needed, key: value}) for key, value in rows))
    for (key, value), text in zip(rows, found, strict=True):
        assert text.startswith(f"{key}"), (key, value, text)
        assert "pydantic" not in text and "\n" not in text


def test_a_breakpoint_takes_nothing_else() -> None:
    rows: list[dict[str, Any]] = [{"line": 1, "cond": "x"}, {"line": "1"}, {"line": 1, "condition": 3}, {}]
    for text in answers(*(("debug_breakpoints", {"session": 1, "lines": [row]}) for row in rows)):
        assert text.startswith("lines.0."), text


# ---------------------------------------------------------------- beside the command line

BESIDE = {
    "until_s": ("--until", ["-1", "nan", "-inf", "-0.001", "0", "inf", "0.05", "1e300"]),
    "seed": ("--seed", ["-1", "0", "7"]),
    "firmware": ("--firmware", ["2.14", "9.9", ""]),
    "robot": ("--robot", ["CS66", "CS99", "", "cs66"]),
    "joints": ("--joints", ["0,0,0,0,0,0", "1,2", "0,0,0,0,0,nan", "0,0,0,0,0,inf", "9,9,9,9,9,99"]),
    "set": (
        "--set",
        [
            "standard_digital_in[3]=true",
            "standard_digital_in[99]=true",
            "standard_digital_in[3]=5",
            "standard_digital_inn[3]=true",
            "parts=3",
            "standart_digital_in=1",
            "a b=1",
            "=1",
        ],
    ),
    "strict": ("--strict", [""]),
}
"""Arguments of the tools that run a program with the option of `run`, and values of it; typed by hand."""
NOT_OPTIONS = {"file", "text", "world", "from_s", "to_s", "step_s"}


def test_each_argument_of_what_runs_programs_has_its_option() -> None:
    for name in ("check", "run", "trace", "debug_start"):
        assert set(TOOLS[name]["properties"]) - NOT_OPTIONS <= set(BESIDE), name


def value_of(argument: str, text: str) -> Any:
    """Return the value of JSON for the text of an option."""
    if argument == "joints":
        return [float(part) for part in text.split(",")]
    if argument == "set":
        name, _, value = text.partition("=")
        return {name: {"true": True}.get(value, value if not value.isdigit() else int(value))}
    if argument == "strict":
        return True
    return {"until_s": float, "seed": int}.get(argument, str)(text)


def asked(do: str, argument: str, text: str) -> str:
    """Return what a worker refuses a request with; empty if it does not."""
    request = {"do": do, "name": "a.script", "text": PROGRAM, argument: value_of(argument, text), "wall_s": 20.0}
    if do == "trace":
        request |= {"from_s": 0.0, "to_s": 0.1, "step_s": 0.1}
    answer = answer_to(json.dumps(request), requests())
    return str(answer.get("error", ""))


@pytest.mark.parametrize(("argument", "text"), [(key, text) for key, (_, texts) in BESIDE.items() for text in texts])
def test_what_the_command_line_refuses_is_refused(
    argument: str, text: str, tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    option = BESIDE[argument][0]
    path = tmp_path / "a.script"
    path.write_text(PROGRAM)
    try:
        code = main(["run", str(path), *([option] if argument == "strict" else [f"{option}={text}"])])
    except SystemExit as ended:
        code = ended.code  # type: ignore[assignment]
    words = capsys.readouterr().err
    for do in ("run", "trace", "debug_start"):
        if f"{argument}" not in TOOLS[do]["properties"]:
            continue
        refused = asked(do, argument, text)
        assert bool(refused) == (code == 2), (do, refused, words)
        if refused and f"{option} must be" in words:
            same = words.partition(f"{option} must be")[2].strip()
            assert same in refused, (do, refused, words)
