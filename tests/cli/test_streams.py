"""Standard streams without a reader, closed, or on a full disk: exit codes stay true, and files whole or not there."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BufferedWriter, TextIOWrapper
from pathlib import Path
from typing import Any, Final

import pytest

from elitescript.cli.output.streams import ENDS, GOES_ON, STOPS, WITHOUT_READER, StandardStream
from elitescript.environment.stop_signals import Stopped
from elitescript.records import NamedTuple
from tests.cli.calls import CALLS, Call, beside, chosen, finish, of, prepare

pytestmark = pytest.mark.skipif(os.name != "posix", reason="needs descriptors of a Unix")

SIGPIPE: Final = 141
"""Exit code of a process that SIGPIPE has ended, as shells count it."""


# ---------------------------------------------------------------- one stream


@contextmanager
def stream_at(descriptor: int, number: int, kind: Any) -> Iterator[TextIOWrapper]:
    """A standard stream that writes to a descriptor in the place of `number`."""
    kept = os.dup(number)
    os.dup2(descriptor, number)
    try:
        yield TextIOWrapper(BufferedWriter(StandardStream(number, kind)), encoding="utf-8", write_through=True)
    finally:
        os.dup2(kept, number)
        os.close(kept)
        os.close(descriptor)


def gone() -> int:
    """A pipe without a reader."""
    reader, writer = os.pipe()
    os.close(reader)
    return writer


def full() -> int:
    """A disk that is full."""
    return os.open("/dev/full", os.O_WRONLY)


class TestAStream:
    @pytest.mark.parametrize("number", [1, 2])
    def test_without_a_reader_a_command_goes_on(self, number: int) -> None:
        with stream_at(gone(), number, GOES_ON) as stream:
            for _ in range(3):
                stream.write("x" * 100_000)
                stream.flush()
            raw = stream.buffer.raw
            assert (raw.has_no_reader, raw.failure) == (True, None)

    @pytest.mark.parametrize("number", [1, 2])
    def test_or_it_ends_once(self, number: int) -> None:
        with stream_at(gone(), number, ENDS) as stream:
            with pytest.raises(Stopped) as stopped:
                print("a", file=stream, flush=True)
            assert stopped.value.number == signal.SIGPIPE
            # What its clean-up prints is dropped.
            print("b", file=stream, flush=True)

    def test_or_it_gets_the_signal_that_it_handles(self) -> None:
        came: list[int] = []
        before = signal.signal(signal.SIGTERM, lambda number, frame: came.append(number))
        try:
            with stream_at(gone(), 1, STOPS) as stream:
                print("a", file=stream, flush=True)
                print("b", file=stream, flush=True)
        finally:
            signal.signal(signal.SIGTERM, before)
        assert came == [signal.SIGTERM]

    def test_a_signal_that_it_does_not_handle_is_no_way(self) -> None:
        assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
        with stream_at(gone(), 1, STOPS) as stream, pytest.raises(Stopped):
            print("a", file=stream, flush=True)

    @pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a full device")
    def test_a_full_disk_is_told_with_the_name_of_the_stream(self) -> None:
        with stream_at(full(), 1, ENDS) as stream:
            with pytest.raises(OSError) as failed:
                print("a", file=stream, flush=True)
            print("b", file=stream, flush=True)
        assert (failed.value.errno, failed.value.filename) == (errno.ENOSPC, "standard output")

    @pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a full device")
    def test_a_full_disk_below_standard_error_ends_nothing(self) -> None:
        with stream_at(full(), 2, ENDS) as stream:
            print("a", file=stream, flush=True)
            assert stream.buffer.raw.failure.filename == "standard error"

    def test_a_pipe_that_does_not_block_is_waited_for(self) -> None:
        reader, writer = os.pipe()
        os.set_blocking(writer, False)
        read: list[bytes] = []

        def take() -> None:
            with os.fdopen(reader, "rb") as file:
                read.append(file.read())

        thread = threading.Thread(target=take)
        with stream_at(writer, 1, GOES_ON) as stream:
            thread.start()
            stream.write("x" * 500_000)
            stream.flush()
        thread.join()
        assert len(read[0]) == 500_000


# ---------------------------------------------------------------- commands and situations


class Situation(NamedTuple):
    """How a call is started.

    Attributes:
        redirected: what a shell has behind the call.
        opened: what makes the descriptor 9, which that may name; None for none.
        code: exit code of a call, if it is started so.
    """

    redirected: str
    opened: Callable[[], int] | None
    code: Callable[[Call], int]


def _without_reader(call: Call) -> int:
    # A language server whose client has gone without a word ends with 1, says its protocol.
    return SIGPIPE if call.may_be_endless and call.prints else 1 if call.command == "lsp" else call.code


def _without_readers(call: Call) -> int:
    return SIGPIPE if call.may_be_endless else _without_reader(call)


def _full(call: Call) -> int:
    return 2 if call.prints else _without_reader(call)


def _without_input(call: Call) -> int:
    # No text is a program without errors.
    return {"check -": 0, "lsp": 1}.get(call.name, call.code)


def _without_output(call: Call) -> int:
    return call.code


SITUATIONS: Final = {
    "no reader": Situation(">&9", gone, _without_reader),
    "no reader of both": Situation(">&9 2>&9", gone, _without_readers),
    "full disk": Situation(">&9", full, _full),
    "closed": Situation("<&- >&- 2>&-", None, _without_input),
    "closed output": Situation(">&-", None, _without_output),
    "closed errors": Situation("2>&-", None, _without_output),
    "closed input": Situation("<&-", None, _without_input),
    "closed output and errors": Situation(">&- 2>&-", None, _without_output),
}

QUICK: Final = (
    ("no reader", "run --state"),
    ("no reader", "check json"),
    ("full disk", "check broken"),
    ("closed", "run --trace"),
    ("closed output", "fmt --check"),
)
"""What every run of the tests tries; the whole table takes minutes."""


def tried(call: Call, name: str, folder: Path) -> subprocess.CompletedProcess[bytes]:
    """Run a call in a situation; standard streams that it does not name are files."""
    situation = SITUATIONS[name]
    (folder / "input").write_text(call.input)
    place = folder / "w"
    place.mkdir()
    prepare(call, place)
    opened = () if situation.opened is None else (situation.opened(),)
    try:
        with beside(call, place) as words:
            shell = f'exec "$@" <../input >../output 2>../errors {situation.redirected}'
            command = [sys.executable, "-P", "-m", "elitescript", *call.words, *words]
            if opened:
                shell = shell.replace("&9", f"&{opened[0]}")
            process = subprocess.Popen(["bash", "-c", shell, "-", *command], cwd=place, pass_fds=opened)
            for descriptor in opened:
                os.close(descriptor)
            opened = ()
            try:
                code = _end_of(process, call, folder)
            finally:
                process.kill()
                process.wait()
    finally:
        for descriptor in opened:
            os.close(descriptor)
    texts = [path.read_bytes() if (path := folder / file).exists() else b"" for file in ("output", "errors")]
    return subprocess.CompletedProcess(command, code, *texts)


def _end_of(process: subprocess.Popen[bytes], call: Call, folder: Path) -> int:
    """Wait for the end of a call; one that only a signal ends gets it when it listens."""
    if call.ends == "signal":
        for _ in range(600):
            if process.poll() is not None or _handles_sigterm(process.pid):
                break
            threading.Event().wait(0.05)
        process.send_signal(signal.SIGTERM)
    return process.wait(timeout=100)


def _handles_sigterm(process: int) -> bool:
    rows = Path(f"/proc/{process}/status").read_text().splitlines()
    caught = next(int(row.split()[1], 16) for row in rows if row.startswith("SigCgt"))
    return bool(caught >> signal.SIGTERM - 1 & 1)


def assert_true(call: Call, name: str, folder: Path) -> None:
    """Assert that a call in a situation has its exit code, says nothing of Python, and leaves whole files or none."""
    done = tried(call, name, folder)
    expected = SITUATIONS[name].code(call)
    assert done.returncode == expected, done.stderr.decode()
    assert b"Traceback" not in done.stderr
    assert b"Exception" not in done.stderr
    if expected == 2:
        assert done.stderr.endswith(b": standard output: No space left on device\n")
    written = [file for file in call.writes if (folder / "w" / file).exists()]
    if expected == call.code:
        assert written == list(call.writes)
    same = [file for file in written if file.endswith((".csv", ".json", ".html"))]
    whole = reference(call, folder / "whole") if same else {}
    for file in same:
        assert (folder / "w" / file).read_bytes() == whole[file]


def reference(call: Call, folder: Path) -> dict[str, bytes]:
    """Return what a call writes that nothing disturbs."""
    folder.mkdir()
    prepare(call, folder)
    finish(call, folder)
    return {file: (folder / file).read_bytes() for file in call.writes}


@pytest.mark.parametrize(("name", "call"), QUICK)
def test_a_call_ends_as_it_should(name: str, call: str, tmp_path: Path) -> None:
    assert_true(of(call), name, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", SITUATIONS)
@pytest.mark.parametrize("call", chosen())
def test_every_call_ends_as_it_should(call: Call, name: str, tmp_path: Path) -> None:
    if (name, call.name) not in QUICK:
        assert_true(call, name, tmp_path)


def test_what_commands_do_without_a_reader_is_what_the_calls_say() -> None:
    endless = {call.command for call in CALLS if call.may_be_endless}
    assert {command for command, kind in WITHOUT_READER.items() if kind != GOES_ON} == endless


@pytest.mark.slow
def test_a_sweep_without_a_reader_can_be_resumed(tmp_path: Path) -> None:
    call = of("sweep --out")
    done = tried(call, "no reader", tmp_path)
    assert done.returncode == SIGPIPE
    assert b"ended by the end of its reader; 1 of 2 runs are done; --resume goes on from out.csv.part" in done.stderr
    resumed = finish(call, tmp_path / "w", ["--resume"])
    assert (resumed.returncode, (tmp_path / "w" / "out.csv.part").exists()) == (0, False)
    assert (tmp_path / "w" / "out.csv").read_bytes() == reference(call, tmp_path / "whole")["out.csv"]
