"""Reports that name nodes: coverage, workflow commands, SARIF."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.cli.main import main
from elitescript.coverage.analysis import analyse, program_coverage
from elitescript.coverage.cobertura import cobertura
from elitescript.coverage.html_pages import html_pages
from elitescript.coverage.json_report import json_report
from elitescript.coverage.lcov import lcov
from elitescript.coverage.terminal import missing_text
from elitescript.coverage.unmet import Unmet
from elitescript.environment.program_file import source_of
from elitescript.lint.engine import check_source
from elitescript.pytest_plugin.strictness import _with_place

XML = """<EliTask name="cell" robotType="CS66">
  <MainTask isTaskAlwaysLoops="false" hasInitVariables="false" typeName="Robot Main Task">
    <ScriptNode scriptType="LINE_TYPE" typeName="Script">
      <Expression><ExpressionTokenCell token="n" scriptCode="n = 1"/></Expression>
    </ScriptNode>
    <IfNode typeName="If">
      <Expression><ExpressionTokenCell token="n" scriptCode="n &gt; 1"/></Expression>
      <children>
        <WaitNode type="WAIT_TIME" typeName="Wait"><waitTime value="0.5" unit="S"/></WaitNode>
        <HaltNode typeName="Halt"/>
      </children>
    </IfNode>
    <SetNode type="DIGITAL_OUTPUT" typeName="Set">
      <digitalOutputPinName>digital_out[16]</digitalOutputPinName><digitalOutputPinValue>HIGH</digitalOutputPinValue>
    </SetNode>
  </MainTask>
</EliTask>
"""


@pytest.fixture
def cell(tmp_path: Path) -> Path:
    path = tmp_path / "cell.task"
    path.write_text(XML)
    return path


def test_coverage_by_node(cell: Path) -> None:
    """Two runs: the script line and the condition ran, what stands in the condition did not."""
    source = source_of(cell)
    program = analyse(source)
    counts = [2 if "sleep" not in text and "halt" not in text else 0 for text in _statements(source.text)]
    # Last is the side of the condition on which no statement stands.
    found = program_coverage("cell.task", program, [*counts, 2])
    assert [(node.place, node.hits) for node in found.nodes] == [
        ("1 Robot Main Task > 2 Script", 2),
        ("1 Robot Main Task > 3 If", 2),
        ("3 If > 4 Wait", 0),
        ("3 If > 5 Halt", 0),
        ("1 Robot Main Task > 6 Set", 2),
    ]
    branch = next(row for row in found.branches if row.hits == 0)
    missing = f"3 If > 4 Wait, 3 If > 5 Halt, 1 Robot Main Task > 3 If ({branch.text})"
    assert missing_text(found) == missing
    nodes = json.loads(json_report([found], Unmet()))["programs"][0]["nodes"]
    assert nodes[2] == {"node": "3 If > 4 Wait", "hits": 0}
    assert '<tr class="miss"><td>3 If &gt; 4 Wait</td><td>0</td></tr>' in "".join(html_pages([found], Unmet()).values())
    # Reports for other tools count lines of the file, which these open.
    lines = [(3, 2), (6, 2), (9, 0), (10, 0), (13, 2)]
    assert [row for row in lcov([found.in_file()]).splitlines() if row.startswith("DA:")] == [
        f"DA:{line},{hits}" for line, hits in lines
    ]
    assert '<line number="9" hits="0"/>' in cobertura([found.in_file()], root="/", version="1", time_ms=0)


def _statements(text: str) -> list[str]:
    """Return the lines of a script that are counted."""
    lines = [line.strip() for line in text.split("\n")]
    return [line for line in lines if line and not line.startswith(("#", "$", "def ", "end", "global"))]


def test_workflow_commands_name_the_node_and_the_line_of_the_file(
    cell: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", str(cell), "--format", "github"]) == 3
    (line,) = [row for row in capsys.readouterr().out.splitlines() if row.startswith("::error")]
    assert "cell.task,line=13,title=E305" in line
    assert "::1 Robot Main Task > 6 Set (script line " in line


def test_sarif_names_the_node_and_the_line_of_the_file(cell: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(cell), "--format", "sarif"]) == 3
    (result,) = [row for row in json.loads(capsys.readouterr().out)["runs"][0]["results"] if row["level"] == "error"]
    (location,) = result["locations"]
    assert location["physicalLocation"]["region"] == {"startLine": 13}
    assert location["logicalLocations"] == [{"fullyQualifiedName": "1 Robot Main Task > 6 Set"}]
    assert result["message"]["text"].startswith("1 Robot Main Task > 6 Set (script line ")


def test_findings_of_tests_name_the_node(cell: Path) -> None:
    robot = VirtualRobot("CS66")
    source = source_of(cell)
    (found,) = [row for row in check_source(source, robot.profile, arm=robot.model) if row.is_error]
    assert _with_place(found, source).startswith(f"{cell}: 1 Robot Main Task > 6 Set (script line ")
