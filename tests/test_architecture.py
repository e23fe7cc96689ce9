"""The rules that keep the house in order: imports, words, handlers, start-up."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from array import array
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FrameType
from typing import ClassVar, get_args

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


@cache
def statements() -> dict[Path, list[ast.Import | ast.ImportFrom | ast.Global]]:
    """Return the statements of each module of ours that name what is outside of it, at the top or within others."""
    found = {}
    for path in MODULES:
        found[path] = kept = []
        left: list[ast.AST] = [ast.parse(path.read_text(encoding="utf-8"))]
        while left:
            node = left.pop()
            if isinstance(node, ast.Import | ast.ImportFrom | ast.Global):
                kept.append(node)
            for inner in ("body", "orelse", "handlers", "finalbody", "cases"):
                left += getattr(node, inner, ())
    return found


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
        pure -= {f"elitescript.{name}" for name in ("environment", "devices", "world_file", "outputs")}
        assert set(contracts["pure"]["source_modules"]) == pure


class TestCycles:
    """No module and no package imports itself by way of others.

    Imports under `TYPE_CHECKING` and inside functions count too: what a file has to know, it has to know then as well.
    """

    def test_modules_have_none(self):
        assert cycles(imports_of_modules()) == []

    def test_packages_have_none(self):
        packages: dict[str, set[str]] = {}
        for module, imported in imports_of_modules().items():
            package = module.split(".")[1] if "." in module else ""
            others = {name.split(".")[1] for name in imported if "." in name}
            packages.setdefault(package, set()).update(others - {package})
        assert cycles(packages) == []

    def test_a_cycle_is_found(self):
        assert cycles({"a": {"b"}, "b": {"c", "d"}, "c": {"a"}, "d": {"d", "e"}, "e": set()}) == [{"a", "b", "c"}]


def imports_of_modules() -> dict[str, set[str]]:
    """Return the modules of ours that each module of ours names in an import statement, wherever that stands."""
    paths = {}
    for path in MODULES:
        parts = path.relative_to(SOURCE.parent).with_suffix("").parts
        paths[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    found: dict[str, set[str]] = {}
    for module, path in paths.items():
        names = found[module] = set()
        for node in statements()[path]:
            if isinstance(node, ast.Import):
                names.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module:
                inner = [f"{node.module}.{alias.name}" for alias in node.names]
                names.update(name if name in paths else node.module for name in inner)
        names.intersection_update(paths)
    return found


def cycles(graph: dict[str, set[str]]) -> list[set[str]]:
    """Return the sets of nodes that reach each other (Tarjan 1972), without single nodes."""
    numbers: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    found = []

    def visit(node: str) -> None:
        numbers[node] = lowest[node] = len(numbers)
        stack.append(node)
        for other in sorted(graph[node]):
            if other not in numbers:
                visit(other)
                lowest[node] = min(lowest[node], lowest[other])
            elif other in stack:
                lowest[node] = min(lowest[node], numbers[other])
        if lowest[node] == numbers[node]:
            component = set(stack[stack.index(node) :])
            del stack[stack.index(node) :]
            if len(component) > 1:
                found.append(component)

    for node in sorted(graph):
        if node not in numbers:
            visit(node)
    return found


class TestPage:
    """ARCHITECTURE.md against the code: packages, places of facts, walks."""

    TEXT = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    LINES_MAX = 195
    """Three screens."""

    @classmethod
    def section(cls, title: str) -> str:
        return cls.TEXT.partition(f"\n## {title}")[2].partition("\n## ")[0]

    @classmethod
    def rows(cls, title: str) -> list[list[str]]:
        lines = [line for line in cls.section(title).splitlines() if line.startswith("|")]
        return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines[2:]]

    @staticmethod
    def imported() -> dict[str, set[str]]:
        """Packages of ours that each package imports, whether at the top, in a function or for types."""
        found: dict[str, set[str]] = {}
        for path, nodes in statements().items():
            package = path.relative_to(SOURCE).parts[0].removesuffix(".py")
            names = found.setdefault(package, set())
            for node in nodes:
                if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("elitescript."):
                    names.add(str(node.module).split(".")[1])
        return {package: names - {package} for package, names in found.items() if not package.startswith("__")}

    def test_it_fits_on_three_screens(self):
        assert len(self.TEXT.splitlines()) <= self.LINES_MAX

    def test_every_package_knows_what_the_table_says(self):
        imported = self.imported()
        table = {row[0].strip("`"): row[2] for row in self.rows("Packages")}
        assert set(table) == set(imported)
        order = list(table)
        for package, cell in table.items():
            if cell == "all rows above":
                assert imported[package] <= set(order[: order.index(package)]), package
            elif cell != "all":
                listed = set() if cell == "nothing" else {name.strip(" `") for name in cell.split(",")}
                assert imported[package] == listed, package

    def test_every_fact_has_one_row_and_its_places_exist(self):
        rows = self.rows("One fact, one place")
        facts = [row[0] for row in rows]
        assert len(facts) == len(set(facts))
        places = re.findall(r"`([\w/<>]+(?:\.\w+|/))`", "".join(row[1] for row in rows))
        assert len(places) >= len(rows)
        missing = [
            place
            for place in places
            if "<" not in place and not (SOURCE / place).exists() and not (ROOT / place).exists()
        ]
        assert missing == []

    def walk(self, title: str) -> list[str]:
        return re.findall(r"^([a-z_/]+\.py) ", self.section(title), re.MULTILINE)

    @staticmethod
    @contextmanager
    def recorded() -> Iterator[list[str]]:
        """Record files of ours in the order of the calls into them; one entry for calls in a row."""
        found: list[str] = []

        def note(frame: FrameType, event: str, _argument: object) -> None:
            path = frame.f_code.co_filename
            if event == "call" and path.startswith(f"{SOURCE}/"):
                file = path[len(f"{SOURCE}/") :]
                if found[-1:] != [file]:
                    found.append(file)

        before = sys.getprofile()
        sys.setprofile(note)
        try:
            yield found
        finally:
            sys.setprofile(before)

    @staticmethod
    def not_reached(walk: list[str], called: list[str]) -> str:
        """First file of a walk that no call enters after the files before it; empty if all are entered in order."""
        rest = iter(called)
        return next((file for file in walk if file not in rest), "")

    def test_the_walk_of_a_move_is_the_real_one(self):
        from elitescript.robot import VirtualRobot

        robot = VirtualRobot()
        text = "def walk():\n    movej([0, -1.5, -1.6, -1.5, 1.5, 0], a=1, v=1)\nend\n"
        with self.recorded() as called:
            robot.run(text, trace=True)
        walk = self.walk("Walk 1")
        assert len(walk) > 10
        assert self.not_reached(walk, called) == ""
        assert self.not_reached(walk[::-1], called) != ""

    def test_the_walk_of_a_program_on_a_port_is_the_real_one(self):
        from elitescript.kernel import Kernel, RobotOptions
        from tests.services.served import run, serving

        async def served() -> None:
            async with serving(Kernel(RobotOptions(power_on=True))) as scene:
                client = await scene.connect("primary")
                with self.recorded() as files:
                    client.send(b'def walk():\n  textmsg("first line")\nend\n')
                    await scene.until(lambda: any(getattr(said, "text", "") == "first line" for said in scene.said))
                called.extend(files)

        called: list[str] = []
        run(served())
        walk = self.walk("Walk 2")
        assert len(walk) > 5
        assert self.not_reached(walk, called) == ""
        assert self.not_reached(walk[::-1], called) != ""


class TestFiles:
    def test_no_module_is_a_drawer_for_everything(self):
        drawers = {"utils", "util", "common", "helpers", "manager", "base", "misc"}
        assert [name for name in names(MODULES) if Path(name).stem in drawers] == []

    def test_no_module_level_state_is_rebound(self):
        """`global` in a function of ours means state that two robots in one process would share."""
        found = [
            f"{path.relative_to(ROOT)}:{node.lineno}"
            for path, nodes in statements().items()
            for node in nodes
            if isinstance(node, ast.Global)
        ]
        assert found == []


class TestReads:
    """Files and texts that others wrote are read by `untrusted` alone; each other read stands here with its reason."""

    OWNER = "untrusted/"

    OTHERS: ClassVar = {
        "cli/contact_findings.py": "what its own process writes to it",
        "cli/output/streams.py": "/dev/null",
        "cli/watched.py": "/proc of its own processes",
        "commands/definition/docstring.py": "files of the package",
        "coverage/recording.py": "memory of its own processes",
        "dap/worker.py": "/dev/null",
        "environment/coverage_file.py": "memory of its own processes",
        "environment/state_file.py": "a file that it has looked at, up to a size",
        "lsp/run_worker.py": "what its own process writes to it",
        "mcp/worker.py": "what its own process writes to it",
        "outputs/locking.py": "writes",
        "outputs/writing.py": "writes",
        "page/__init__.py": "files of the package",
        "plotting/plain_page.py": "files of the package",
        "pytest_plugin/served.py": "what its own process writes",
        "runtime/addresses.py": "/proc of its own process",
        "services/child/jail.py": "folders, not read",
        "services/child/process.py": "/proc of its own processes",
        "studio/live/link.py": "what its own process writes to it",
        "studio/live/worker.py": "/dev/null",
        "studio/services.py": "files of the package",
        "sweep/engines/cluster.py": "what its own process writes",
        "sweep/engines/cluster_worker.py": "what its own process writes to it",
        "sweep/engines/reference.py": "what its own process writes",
        "sweep/results/table_files.py": "files that it has looked at, in blocks and bounded lines",
        "sweep/results/journal.py": "a file that it has looked at and locked, line by line",
    }

    HINT = re.compile(r"read_text|read_bytes|open\(|json\.load|tomllib")

    @classmethod
    def reads(cls, text: str) -> set[str]:
        """Return the calls of a module that read a file of this computer, or parse JSON or TOML without bounds."""
        found: set[str] = set()
        if not cls.HINT.search(text):
            return found
        for node in ast.walk(ast.parse(text)):
            if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name | ast.Attribute):
                continue
            last = node.func.id if isinstance(node.func, ast.Name) else node.func.attr
            if last not in ("read_text", "read_bytes", "open", "load", "loads"):
                continue
            name = ast.unparse(node.func)
            is_of_path = last.startswith("read_") and "." in name and not name.startswith("untrusted_files.")
            is_parser = name in (
                "json.load",
                "json.loads",
                "tomllib.load",
                "tomllib.loads",
                "os.open",
                "open",
                "io.open",
            )
            mode = next((arg.value for arg in node.args[:1] if isinstance(arg, ast.Constant)), None)
            is_opened = last == "open" and isinstance(mode, str) and set(mode) <= set("rwaxbt+")
            if is_parser or is_opened or is_of_path:
                found.add(name)
        return found

    def test_they_go_through_their_owner(self):
        names = {path.relative_to(SOURCE).as_posix(): path for path in MODULES}
        found = {name for name, path in names.items() if self.reads(path.read_text(encoding="utf-8"))}
        assert {name for name in found if not name.startswith(self.OWNER)} == set(self.OTHERS)

    @pytest.mark.parametrize(
        "text",
        [
            "Path(x).read_text()",
            "path.open('rb')",
            "json.loads(line)",
            "tomllib.loads(t)",
            "open(name)",
            "os.open(p, 0)",
        ],
    )
    def test_a_read_is_found(self, text):
        assert self.reads(text)

    def test_other_calls_are_none(self):
        assert self.reads("channels.open(address, port, 2.0); files.open(name, mode, None, None)") == set()


class TestWrites:
    """Files are written by `outputs` alone; each other write stands here with its reason."""

    OWNER = "outputs/"

    OTHERS: ClassVar = {
        "audit/auditing.py": "into a folder of its own",
        "cli/output/streams.py": "/dev/null",
        "environment/coverage_file.py": "memory of its own processes",
        "services/journal/file.py": "cuts what it could not write whole from its own journal",
        "sweep/many_runs.py": "moves its own journal",
        "sweep/results/journal.py": "a journal that it has locked",
    }

    @staticmethod
    def writes(text: str) -> set[str]:
        """Return the calls of a module that make, change, move or replace a file of this computer."""
        found: set[str] = set()
        for node in ast.walk(ast.parse(text)):
            if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name | ast.Attribute):
                continue
            name = ast.unparse(node.func)
            last = name.rpartition(".")[2]
            modes = [arg.value for arg in node.args[:2] if isinstance(arg, ast.Constant) and isinstance(arg.value, str)]
            is_mode = any(set(mode) <= set("rwaxbt+") and set(mode) & set("wax+") for mode in modes if mode)
            is_path = len(node.args) == 1 and not node.keywords
            if (
                (last in ("open", "FileIO") and is_mode and "files.open" not in name)
                or (last == "write_text" and "." in name and not name.startswith("values."))
                or last in ("write_bytes", "mkstemp", "NamedTemporaryFile", "ftruncate")
                or (name == "os.open" and "O_RDONLY" not in ast.unparse(node) and "O_PATH" not in ast.unparse(node))
                or (last in ("replace", "rename") and is_path and not name.startswith(("census.", "self.record.")))
                or name in ("os.replace", "os.rename", "shutil.move", "shutil.copyfile", "shutil.copy", "shutil.copy2")
            ):
                found.add(name)
        return found

    def test_they_go_through_their_owner(self):
        names = {path.relative_to(SOURCE).as_posix(): path for path in MODULES}
        found = {name: self.writes(path.read_text(encoding="utf-8")) for name, path in names.items()}
        left = {name for name, calls in found.items() if calls and not name.startswith(self.OWNER)}
        assert left == set(self.OTHERS), {name: found[name] for name in left ^ set(self.OTHERS)}

    @pytest.mark.parametrize(
        "text",
        [
            "Path(x).write_text(y)",
            "path.write_bytes(y)",
            "path.open('wb')",
            "open(name, 'a')",
            "os.open(p, os.O_WRONLY)",
            "temporary.replace(path)",
            "os.replace(a, b)",
            "mkstemp(dir=folder)",
        ],
    )
    def test_a_write_is_found(self, text):
        assert self.writes(text)

    def test_other_calls_are_none(self):
        text = "text.replace('a', 'b'); open(name); path.open('rb'); os.open(p, os.O_RDONLY); replace(row, name=1)"
        assert self.writes(text) == set()


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
        for lock in ROOT.glob("requirements-*.lock"):
            assert "://" not in lock.read_text()


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
        assert parts <= {"commands", "kinematics", "messages", "errors", "records", "said", "sealed", "shown"}

    def test_the_checker_loads_no_machine_and_no_runtime(self):
        loaded = self.modules_after("import elitescript.lint.engine")
        parts = {name.split(".")[1] for name in loaded if name.startswith("elitescript.")}
        below = {"kinematics", "messages", "errors", "records", "said", "sealed", "shown", "untrusted", "paths"}
        assert parts <= {"lint", "commands", "language"} | below

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

    NOT_FOR_A_LINE = frozenset(
        (
            *("argparse", "asyncio", "bz2", "copy", "csv", "dataclasses", "datetime", "decimal", "gettext", "inspect"),
            *("json", "locale", "logging", "lzma", "pkgutil", "random", "shutil", "socket", "string", "subprocess"),
            *("tempfile", "threading", "tokenize", "tomllib", "traceback", "xmlrpc"),
        )
    )

    @staticmethod
    def start(tmp_path: Path, command: str) -> tuple[set[str], int]:
        """Return the modules that a call for a program of one line loads, and how many methods of records it makes."""
        program = tmp_path / "hello.script"
        program.write_text('textmsg("hello")\n')
        call = f"""
import sys
from elitescript import records
written = records._written
made = []
records._written = lambda *arguments: made.append(1) or written(*arguments)
from elitescript.cli.main import main
assert main([{command!r}, {str(program)!r}]) == 0
print("loaded", len(made), *sys.modules)
"""
        done = subprocess.run(
            [sys.executable, "-c", call], cwd=ROOT / "src", capture_output=True, text=True, check=True
        )
        _, count, *modules = done.stdout.splitlines()[-1].split()
        return set(modules), int(count)

    @pytest.mark.parametrize(("command", "modules_max", "methods_max"), [("run", 310, 70), ("check", 185, 35)])
    def test_a_line_takes_few_modules_and_methods(self, command, modules_max, methods_max, tmp_path):
        """Each module takes 0.15 ms, each method 0.1 ms: raise a bound only for what every program needs."""
        loaded, methods = self.start(tmp_path, command)
        assert loaded & self.NOT_FOR_A_LINE == set()
        assert len([name for name in loaded if name.startswith("elitescript")]) <= modules_max
        assert methods <= methods_max

    def test_classes_of_data_are_made_by_records_alone(self):
        """`dataclasses` and `typing.NamedTuple` compile their methods when a module is imported."""
        makers = re.compile(
            r"^\s*(from dataclasses import .*\bdataclass\b|from typing import .*\bNamedTuple\b)", re.MULTILINE
        )
        left = {"records.py", "transport.py", "signal_lanes.py"}
        found = {path.name for path in MODULES if makers.search(path.read_text(encoding="utf-8"))}
        assert found <= left
