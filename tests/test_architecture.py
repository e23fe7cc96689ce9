"""The rules that keep the house in order: imports, words, handlers, start-up."""

from __future__ import annotations

import ast
import subprocess
import sys
import tomllib
from array import array
from pathlib import Path
from typing import get_args

import pytest

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "src" / "elitescript"
MODULES = sorted(SOURCE.rglob("*.py"))
BINARY = {".png", ".ico", ".woff2", ".gz"}


def names(paths):
    return [str(path.relative_to(ROOT)) for path in paths]


def tracked_files() -> list[Path]:
    """Files of the repository; in an unpacked archive without git, all but what tools left there."""
    listing = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False)
    if listing.returncode == 0:
        paths = [ROOT / name for name in listing.stdout.decode().split("\0") if name]
    else:
        left_by_tools = {".venv", "build", "dist", "__pycache__"}
        paths = [
            path
            for path in ROOT.rglob("*")
            if not any(part in left_by_tools or part.endswith("_cache") for part in path.relative_to(ROOT).parts)
        ]
    return [path for path in paths if path.is_file() and path.suffix not in BINARY]


class TestImports:
    def test_they_keep_their_directions(self, tmp_path, monkeypatch, capsys):
        lint_imports = pytest.importorskip("importlinter.cli").lint_imports
        monkeypatch.chdir(ROOT)
        monkeypatch.syspath_prepend(str(ROOT / "src"))
        code = lint_imports(no_cache=True, cache_dir=str(tmp_path))
        assert code == 0, capsys.readouterr().out

    def test_every_pure_package_is_under_the_ban(self):
        """A new package below `robot` may not be forgotten in the contract."""
        config = tomllib.loads((ROOT / "pyproject.toml").read_text())
        contracts = {contract["id"]: contract for contract in config["tool"]["importlinter"]["contracts"]}
        layers = contracts["layers"]["layers"]
        below = layers[layers.index("robot") + 1 :]
        pure = {f"elitescript.{name.strip()}" for row in below for name in row.split("|")}
        pure -= {"elitescript.environment", "elitescript.devices", "elitescript.world_file"}
        assert set(contracts["pure"]["source_modules"]) == pure


class TestFiles:
    def test_no_module_is_a_drawer_for_everything(self):
        drawers = {"utils", "util", "common", "helpers", "manager", "base", "misc"}
        assert [name for name in names(MODULES) if Path(name).stem in drawers] == []

    def test_no_module_level_state_is_rebound(self):
        """`global` in a function of ours means state that two robots in one process would share."""
        found = [
            f"{path.relative_to(ROOT)}:{node.lineno}"
            for path in MODULES
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.Global)
        ]
        assert found == []


class TestWords:
    """The repository speaks of the product alone, and names no place that only one machine has."""

    # Put together, so that this file does not contain them.
    FORBIDDEN = tuple(
        "".join(parts)
        for parts in [
            ("/work", "/"),
            ("work/", "shared"),
            ("shared/", "reference"),
            ("DESIGN", ".md"),
            ("/opt/", "pypi"),
            ("/opt/", "wheels"),
            ("extra-", "index-url"),
            ("--index", "-url"),
            ("pypi", ".org"),
            ("files.python", "hosted"),
            ("registry.", "npmjs"),
            ("Cla", "ude"),
            ("Anthro", "pic"),
            ("language", " model"),
            ("sub", "agent"),
            ("as an ", "AI"),
        ]
    )

    def test_are_not_there(self):
        found = []
        for path in tracked_files():
            for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
                found += [
                    f"{path.relative_to(ROOT)}:{number}: {word}"
                    for word in self.FORBIDDEN
                    if word.lower() in line.lower()
                ]
        assert found == []

    def test_no_reminders_are_left(self):
        reminders = ("TO" + "DO", "FIX" + "ME", "XX" + "X:")
        found = [
            f"{path.relative_to(ROOT)}:{number}"
            for path in [*MODULES, *sorted((ROOT / "tests").rglob("*.py"))]
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
            if any(word in line for word in reminders)
        ]
        assert found == []

    def test_the_lock_names_no_address(self):
        assert "://" not in (ROOT / "requirements-dev.lock").read_text()


class TestRequests:
    def test_every_machine_request_has_exactly_one_handler(self):
        from elitescript.controller.controller import HANDLERS
        from elitescript.messages.machine import MachineRequest

        assert set(HANDLERS) == set(get_args(MachineRequest))

    def test_every_motion_request_is_understood(self):
        from elitescript.controller.controller import Controller
        from elitescript.messages.motion import (
            MicroLine,
            MotionRequest,
            MoveC,
            MoveJ,
            MoveL,
            MoveML,
            MoveP,
            ServoJ,
            SpeedJ,
            SpeedL,
            StopJ,
            StopL,
        )
        from elitescript.models.model import load_model

        q = (0.0, -1.5, -1.6, -1.5, 1.5, 0.0)
        pose = (0.45, -0.15, 0.45, 3.1, 0.0, -1.5)
        home = array("d", load_model("CS66").home)
        one_point = MicroLine("p.txt", 0.004, False, home.tobytes(), array("I", (1,)).tobytes())
        examples = [
            MoveJ(q, 1.0, 1.0),
            MoveL(pose, 1.0, 0.2),
            MoveC((0.46, -0.12, 0.45, 3.1, 0.0, -1.5), (0.45, -0.09, 0.45, 3.1, 0.0, -1.5), 1.0, 0.2),
            MoveP(pose, 1.0, 0.2),
            MoveML(one_point, 1, 1, 1.0, 1.0),
            SpeedJ((0.1, 0.0, 0.0, 0.0, 0.0, 0.0), 1.0),
            SpeedL((0.0, 0.1, 0.0, 0.0, 0.0, 0.0), 1.0, 1.0),
            ServoJ(q, 0.004, 0.1, 300.0),
            StopJ(1.0),
            StopL(1.0),
        ]
        assert {type(example) for example in examples} == set(get_args(MotionRequest))
        for example in examples:
            controller = Controller(load_model("CS66"), epoch_s=0.0, on_event=lambda event: None)
            assert isinstance(controller.request_motion(example, 1, "main"), int)

    def test_every_code_is_used(self):
        """A row of `errors.CODES` that no source names is a promise that nothing keeps."""
        from elitescript.errors import CODES

        texts = [path.read_text(encoding="utf-8") for path in MODULES if path.name != "errors.py"]
        texts.append((SOURCE / "errors.py").read_text(encoding="utf-8").partition("CODES: Final")[2])
        assert [code for code in CODES if not any(f'"{code}"' in text for text in texts)] == []


class TestStartUp:
    """What a fresh process loads."""

    @staticmethod
    def modules_after(statement: str) -> set[str]:
        program = f"import sys; {statement}; print(*sys.modules)"
        done = subprocess.run(
            [sys.executable, "-c", program], cwd=ROOT / "src", capture_output=True, text=True, check=True
        )
        return set(done.stdout.split())

    def test_the_package_alone_loads_nothing(self):
        loaded = {name for name in self.modules_after("import elitescript") if name.startswith("elitescript")}
        assert loaded == {"elitescript"}

    def test_the_catalogue_loads_no_machine_and_no_runtime(self):
        loaded = self.modules_after("import elitescript.commands.catalogue")
        parts = {name.split(".")[1] for name in loaded if name.startswith("elitescript.")}
        assert parts <= {"commands", "kinematics", "messages", "errors"}

    def test_the_checker_loads_no_machine_and_no_runtime(self):
        loaded = self.modules_after("import elitescript.lint.engine")
        parts = {name.split(".")[1] for name in loaded if name.startswith("elitescript.")}
        assert parts <= {"lint", "commands", "language", "kinematics", "messages", "errors"}

    def test_a_robot_loads_nothing_slow(self):
        slow = {"asyncio", "numpy", "typing_extensions", "multiprocessing", "socket", "subprocess", "unittest"}
        assert self.modules_after("import elitescript.robot") & slow == set()

    def test_a_robot_without_connections_loads_nothing_of_them(self):
        outside = {"elitescript.messages.inputs", "elitescript.modbus", "elitescript.devices.world", "xmlrpc"}
        statement = "from elitescript.robot import VirtualRobot; VirtualRobot().run('textmsg(1)')"
        assert self.modules_after(statement) & outside == set()

    def test_the_command_line_loads_nothing_slow(self):
        slow = {"asyncio", "numpy", "multiprocessing", "socket", "subprocess", "unittest", "json", "csv"}
        assert self.modules_after("import elitescript.cli.main") & slow == set()
