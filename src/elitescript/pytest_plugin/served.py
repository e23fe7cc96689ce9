"""A controller of its own for one test: `elitescript serve` in a process, on free ports of loopback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from queue import Empty, Queue
from threading import Thread
from time import monotonic
from typing import Any, Final

from elitescript.errors import ElitescriptError, UsageError

START_S: Final = 60.0
"""How long a controller may take to open its ports, on a busy computer."""
END_S: Final = 10.0
"""How long it may take to end by itself; then it is killed."""
_PYTHON: Final = (sys.executable, "-P", "-m")
_ENDED: Final = ""


class ServedRobot:
    """A controller that `elitescript serve` serves for one test, with its arm powered on.

    Args:
        arguments: of `serve`, besides those for ports, power and output.
        limit_s: wall time that `ctl` may take, s; None for no limit.

    Attributes:
        host: address of the ports.
        ports: number of each port by its name, such as `dashboard`.
        log: what `serve --json` has printed so far, one dict for each line, the line `ready` first.
        pid: number of the process.

    Raises:
        UsageError: `serve` refuses its arguments.
        ElitescriptError: it does not open its ports in time.
    """

    def __init__(self, arguments: Sequence[str] = (), limit_s: float | None = None) -> None:
        self._limit_s = limit_s
        self.log: list[dict[str, Any]] = []
        self._lines: Queue[str] = Queue()
        words = ["serve", "--json", "--power-on", "--port", "all=0", *arguments]
        self._process = subprocess.Popen(
            [*_PYTHON, "elitescript.pytest_plugin.served_process", *words],
            # Closed when this process ends, in whatever way, which ends the controller.
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            # Else `serve` starts Python once more.
            env={**os.environ, "PYTHONHASHSEED": "0"},
            encoding="utf-8",
            errors="replace",
        )
        self._errors: list[str] = []
        self._readers = [
            Thread(target=self._read_output, name="elitescript serve: output", daemon=True),
            Thread(target=self._read_errors, name="elitescript serve: errors", daemon=True),
        ]
        for reader in self._readers:
            reader.start()
        try:
            ready = self.wait_for("ready", START_S)
        except BaseException:
            self.close()
            raise
        robot = ready["robots"][0]
        self.host: str = ready["host"]
        self.ports: dict[str, int] = robot["ports"]
        self.pid = self._process.pid
        self._control: str = robot["ctl"]

    def wait_for(self, kind: str, within_s: float = END_S, **fields: Any) -> dict[str, Any]:
        """Return the first line of `log` of a type whose fields have these values; wait until it comes.

        Args:
            kind: `type` of the line, such as `log`, `alarm` or `ready`.
            within_s: longest wait, s of the wall clock.
            fields: what the line must hold, such as `text="done"`.

        Raises:
            TimeoutError: it has not come.
            ElitescriptError: the controller has ended before.
        """
        __tracebackhide__ = True
        deadline_s, seen = monotonic() + within_s, 0
        while True:
            for line in self.log[seen:]:
                seen += 1
                if line.get("type") == kind and fields.items() <= line.items():
                    return line
            try:
                text = self._lines.get(timeout=max(0.0, deadline_s - monotonic()))
            except Empty:
                wanted = f"{kind!r} with {fields}" if fields else repr(kind)
                raise TimeoutError(
                    f"no line of type {wanted} within {within_s:g} s; the log has {len(self.log)} lines, "
                    f"the last one is {self.log[-1] if self.log else 'missing'}"
                ) from None
            if text == _ENDED:
                self._lines.put(_ENDED)
                raise self._ended()

    def ctl(self, verb: str, *arguments: str, wait: bool = False) -> dict[str, Any]:
        """Operate the robot as `elitescript ctl` does.

        Args:
            verb: such as `state`, `get`, `set` or `play`.
            arguments: of the verb, as on the command line: `robot.ctl("set", "standard_digital_in[3]=true")`.
            wait: of `play`: return when the task has ended.

        Returns:
            What the verb asks for, by name; the key `text` holds the outcome of an order.

        Raises:
            UsageError: the robot refuses, or there is no such verb.
            TimeoutError: there is no answer within the limit of wall time of a run.
        """
        __tracebackhide__ = True
        words = ["ctl", "--json", "--socket", self._control, *(["--wait"] if wait else []), verb, *arguments]
        command = [*_PYTHON, "elitescript", *words]
        try:
            done = subprocess.run(
                command,
                capture_output=True,
                encoding="utf-8",
                errors="replace",
                stdin=subprocess.DEVNULL,
                timeout=self._limit_s,
            )
        except subprocess.TimeoutExpired:
            raise TimeoutError(
                f"ctl {' '.join(words[4:])}: no answer within {self._limit_s:g} s of wall time, the limit of a run in "
                "pytest; another one, or 0 for none: @pytest.mark.elitescript(wall_limit_s=SECONDS), or "
                "elitescript_wall_limit_s in the ini file"
            ) from None
        try:
            answer = json.loads(done.stdout)
        except ValueError:
            raise UsageError(done.stderr.strip() or f"ctl {verb}: exit code {done.returncode}") from None
        if not answer["ok"]:
            raise UsageError(f"ctl {verb}: {answer['error']}")
        result: Mapping[str, Any] = answer.get("result", {"text": answer.get("text", "")})
        return dict(result)

    @property
    def warnings(self) -> list[str]:
        """Texts of the warnings that the log holds."""
        return [str(line.get("text")) for line in self.log if "warning" in (line.get("type"), line.get("level"))]

    def close(self) -> None:
        """End the process: by a request, and if it does not follow that in time, by force."""
        if self._process.poll() is None:
            self._process.terminate()
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        for reader in self._readers:
            reader.join(END_S)
        for stream in (self._process.stdin, self._process.stdout, self._process.stderr):
            if stream is not None:
                stream.close()

    def _read_output(self) -> None:
        assert self._process.stdout is not None
        for text in self._process.stdout:
            try:
                self.log.append(json.loads(text))
            except ValueError:
                self._errors.append(text)
            self._lines.put(text)
        self._lines.put(_ENDED)

    def _read_errors(self) -> None:
        assert self._process.stderr is not None
        self._errors.extend(self._process.stderr)

    def _ended(self) -> ElitescriptError:
        self._process.wait()
        self._readers[1].join(END_S)
        said = "".join(self._errors).strip()
        text = said or f"elitescript serve has ended with exit code {self._process.returncode}"
        return UsageError(text) if self._process.returncode == 2 else ElitescriptError(text)

    def __repr__(self) -> str:
        return f"<ServedRobot at {self.host}, ports {self.ports}>"
