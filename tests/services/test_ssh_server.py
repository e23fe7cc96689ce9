"""The SSH port, by the client of the library on loopback."""

from __future__ import annotations

import asyncio
import contextlib
import inspect
from collections.abc import AsyncIterator
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from elitescript.messages.inputs import ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import OpenLine
from elitescript.services.clients import turns
from elitescript.services.clients.listener import GUESTS_MAX
from elitescript.services.log import LogLine
from elitescript.services.port_numbers import NAMES
from tests.services.served import Scene, run
from tests.services.test_serial_bridges import free_port

asyncssh = pytest.importorskip("asyncssh")
ssh_server = import_module("elitescript.services.ssh.server")

LOG = "/opt/elite/data/log/log_history.csv"
ROW = b"time,level,source,code,text\n"


class Host:
    """The SSH port of a served robot."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.desk: Any = scene.server._ssh
        self.taps = self.desk.taps
        self.bridges = self.desk._bridges
        self.port = self.desk._port
        self.files = self.port._files
        self.port._wrong_password_s = 0
        self.number = self.desk.number

    @property
    def said(self) -> list[str]:
        return [note.text for note in self.scene.said if isinstance(note, LogLine) and note.is_problem]

    def connect(self, password: str = "secret", username: str = "root") -> Any:
        return asyncssh.connect(
            "127.0.0.1",
            self.number,
            username=username,
            password=password,
            known_hosts=None,
            client_keys=None,
            config=None,
            agent_path=None,
        )


@contextlib.asynccontextmanager
async def hosted() -> AsyncIterator[Host]:
    scene = Scene(ssh_password="secret")
    await scene.server.boot()
    scene.server.bind("127.0.0.1", dict.fromkeys((*NAMES, "ssh"), 0))
    await scene.server.open()
    try:
        yield Host(scene)
    finally:
        await scene.server.close()


class TestLogin:
    def test_the_right_password_is_let_in_and_the_host_key_is_the_one_that_is_shown(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                assert client.get_server_host_key().get_fingerprint() == host.port.fingerprint
                assert host.port.fingerprint.startswith("SHA256:")
                assert host.said == []

        run(scene())

    @pytest.mark.parametrize(
        ("username", "password"), [("root", "secre"), ("root", ""), ("root", "secret "), ("admin", "secret")]
    )
    def test_anything_else_is_refused(self, username: str, password: str) -> None:
        async def scene() -> None:
            async with hosted() as host:
                with pytest.raises(asyncssh.PermissionDenied):
                    await host.connect(password, username)
                assert host.said == ["ssh: a login with a wrong user name or password is refused"]

        run(scene())

    def test_a_connection_has_three_attempts(self) -> None:
        class Guesser(asyncssh.SSHClient):
            guesses = 0

            def password_auth_requested(self) -> str:
                Guesser.guesses += 1
                return f"guess {Guesser.guesses}"

        async def scene() -> None:
            async with hosted() as host:
                with pytest.raises((asyncssh.Error, OSError)):
                    await asyncssh.create_connection(
                        Guesser,
                        "127.0.0.1",
                        host.number,
                        username="root",
                        known_hosts=None,
                        client_keys=None,
                        config=None,
                        agent_path=None,
                    )
                assert Guesser.guesses == 3
                assert len(host.said) == 3

        run(scene())

    def test_connections_are_bounded(self) -> None:
        async def scene() -> None:
            async with hosted() as host, contextlib.AsyncExitStack() as held:
                for _ in range(ssh_server.CLIENTS_MAX):
                    await held.enter_async_context(host.connect())
                with pytest.raises((asyncssh.Error, OSError)):
                    await host.connect()
                assert host.said == ["ssh: a client is refused, 8 have logged in"]

        run(scene())

    def test_nothing_is_worked_on_while_a_password_is_looked_at(self) -> None:
        async def scene() -> None:
            async with hosted() as host:
                host.port._wrong_password_s = 3600
                login = asyncio.ensure_future(host.connect("wrong").__aenter__())
                await host.scene.until(lambda: host.said)
                (served,) = host.desk.listener.clients.values()
                served.connection.receive(bytes(100_000), host.scene.server.output)
                await host.scene.ticks(3)
                assert len(served.connection._raw) == 100_000
                assert served.connection.is_busy
                login.cancel()

        run(scene())


class TestCommands:
    def test_a_variable_is_printed(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                done = await client.run("printenv PATH")
                assert (done.exit_status, done.stdout, done.stderr) == (
                    0,
                    "/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin\n",
                    "",
                )

        run(scene())

    @pytest.mark.parametrize(
        "command", ["printenv PATH; id", "cat /etc/passwd", "sh -c id", "$(id)", "echo x > /tmp/x", "kill", "é\u2028"]
    )
    def test_no_command_reaches_a_shell(self, command: str) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                done = await client.run(command)
                assert (done.exit_status, done.stdout) == (127, "")
                assert "This is no shell" in done.stderr
                assert host.files.names("/tmp") == []

        run(scene())

    def test_only_bridges_can_be_killed(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                for number in (1, 2001):
                    done = await client.run(f"kill {number}")
                    assert (done.exit_status, done.stderr) == (1, f"elitescript: {number} is no bridge\n")

        run(scene())

    def test_there_is_no_shell_no_terminal_no_forwarding_and_no_other_subsystem(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                shell = await client.run(None)
                assert (shell.exit_status, shell.stderr) == (127, "elitescript: there is no shell here.\n")
                with pytest.raises(asyncssh.ChannelOpenError):
                    await client.run("printenv PATH", term_type="xterm")
                with pytest.raises(asyncssh.ChannelOpenError):
                    await client.open_connection("127.0.0.1", host.number)
                with pytest.raises(asyncssh.ChannelListenError):
                    await client.start_server(lambda *_: None, "127.0.0.1", 0)
                other = await client.run(subsystem="netconf")
                assert (other.exit_status, other.stderr) == (
                    127,
                    "elitescript: there is no subsystem 'netconf' here.\n",
                )

        run(scene())

    def test_the_sequence_of_the_vendors_client_bridges_the_tool(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                host.taps.outgoing([OpenLine(7, "tool", LineSettings(115200, 0, 1, 8))])
                host.taps.incoming([ChannelOpened(7, True)])
                port = free_port()
                find = f"ps| grep \"[s]ocat tcp-l:{port}\" | awk '{{print $1}}'"
                start = (
                    f"bash -lc 'socat tcp-l:{port},reuseaddr,fork,nodelay "
                    "file:/dev/ttyTCI0,nonblock,raw,waitlock=/var/run/tty0 > /dev/null 2>&1 &'"
                )
                assert (await client.run(find)).stdout == ""
                assert (await client.run(start)).exit_status == 0
                number = int((await client.run(find)).stdout)
                assert host.bridges.find(port) == number
                again = await client.run(start)
                assert again.exit_status == 1
                assert again.stderr.startswith(f"elitescript: the serial port tool cannot be bridged at port {port}: ")
                assert len(host.said) == 1
                assert (await client.run(f"kill {number}")).exit_status == 0
                assert (await client.run(find)).stdout == ""

        run(scene())


class TestFiles:
    def test_scp_both_ways(self, tmp_path: Path) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                (tmp_path / "up").write_bytes(bytes(range(256)) * 1000)
                await asyncssh.scp(str(tmp_path / "up"), (client, "/tmp/file"))
                await asyncssh.scp((client, "/tmp/file"), str(tmp_path / "down"))
                assert (tmp_path / "down").read_bytes() == bytes(range(256)) * 1000
                await asyncssh.scp((client, LOG), str(tmp_path / "log"))
                assert (tmp_path / "log").read_bytes() == ROW

        run(scene())

    @pytest.mark.parametrize("path", ["/etc/passwd", "../../../etc/passwd", "/tmp/../etc/passwd", "/proc/self/environ"])
    def test_scp_and_sftp_find_no_file_of_this_computer(self, tmp_path: Path, path: str) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                with pytest.raises(asyncssh.SFTPError):
                    await asyncssh.scp((client, path), str(tmp_path / "x"))
                async with client.start_sftp_client() as sftp:
                    with pytest.raises(asyncssh.SFTPNoSuchFile):
                        await sftp.stat(path)
                    with pytest.raises(asyncssh.SFTPNoSuchFile):
                        await sftp.open(path)

        run(scene())

    def test_nothing_is_written_on_this_computer(self, tmp_path: Path) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                (tmp_path / "up").write_bytes(b"x")
                target = tmp_path / "planted"
                with pytest.raises(asyncssh.SFTPError):
                    await asyncssh.scp(str(tmp_path / "up"), (client, str(target)))
                async with client.start_sftp_client() as sftp:
                    with pytest.raises(asyncssh.SFTPError):
                        await sftp.put(str(tmp_path / "up"), str(target))
                    for act in (
                        sftp.symlink("/etc", "/tmp/link"),
                        sftp.link(str(tmp_path / "up"), "/tmp/link"),
                        sftp.readlink("/tmp"),
                        sftp.mkdir(str(tmp_path / "made")),
                        sftp.remove(str(tmp_path / "up")),
                        sftp.rmdir(str(tmp_path)),
                        sftp.chmod(str(tmp_path / "up"), 0o777),
                        sftp.truncate(str(tmp_path / "up"), 0),
                        sftp.rename(str(tmp_path / "up"), "/tmp/moved"),
                        sftp.posix_rename(str(tmp_path / "up"), "/tmp/moved"),
                    ):
                        with pytest.raises(asyncssh.SFTPError):
                            await act
                    assert await sftp.listdir("/tmp") == [".", ".."]
                assert sorted(path.name for path in tmp_path.iterdir()) == ["up"]
                assert (tmp_path / "up").read_bytes() == b"x"

        run(scene())

    def test_a_folder_by_sftp(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client, client.start_sftp_client() as sftp:
                assert await sftp.realpath("..") == "/"
                await sftp.mkdir("/tmp/d")
                async with sftp.open("/tmp/d/a", "w") as file:
                    await file.write("text")
                async with sftp.open("/tmp/d/a", "a") as file:
                    await file.write("!")
                assert await sftp.getsize("/tmp/d/a") == 5
                await sftp.truncate("/tmp/d/a", 2)
                assert (await sftp.stat("/tmp/d/a")).size == 2
                await sftp.utime("/tmp/d/a", (900_000_000, 1_000_000_000))
                assert (await sftp.stat("/tmp/d/a")).mtime == 1_000_000_000
                await sftp.rename("/tmp/d/a", "/tmp/b")
                await sftp.rmdir("/tmp/d")
                assert sorted(await sftp.listdir("/")) == [".", "..", "opt", "tmp"]
                assert await sftp.isdir("/tmp") and await sftp.isfile("/tmp/b")
                assert (await sftp.statvfs("/tmp")).bsize == 4096

        run(scene())

    def test_more_than_there_is_room_for_is_refused(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        monkeypatch.setattr("elitescript.services.ssh.files.BYTES_MAX", 1000)

        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                (tmp_path / "up").write_bytes(bytes(2000))
                with pytest.raises(asyncssh.SFTPError, match="at most"):
                    await asyncssh.scp(str(tmp_path / "up"), (client, "/tmp/a"))
                async with client.start_sftp_client() as sftp, sftp.open("/tmp/b", "w") as file:
                    with pytest.raises(asyncssh.SFTPError):
                        await file.write("x", 1 << 40)
                assert host.files.free >= 0

        run(scene())

    def test_files_that_a_client_leaves_open_are_closed(self) -> None:
        async def scene() -> None:
            async with hosted() as host:
                for _ in range(3):
                    client = await host.connect()
                    sftp = await client.start_sftp_client()
                    for number in range(ssh_server.OPEN_MAX):
                        await sftp.open(f"/tmp/{number}", "w")
                    client.abort()
                    await client.wait_closed()
                    while host.files._open:
                        await asyncio.sleep(0)

        run(scene())


def packet(kind: int, body: bytes, number: int = 1) -> bytes:
    """A request of SFTP."""
    return text(bytes([kind]) + number.to_bytes(4) + body)


def text(data: bytes) -> bytes:
    return len(data).to_bytes(4) + data


INIT = text(b"\1" + (3).to_bytes(4))
OPEN = packet(3, text(b"/tmp/x") + (2 | 8 | 1).to_bytes(4) + bytes(4))
HANDLE = text(bytes(4))


class RawSftp:
    """A client that sends SFTP requests as it likes."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.channel: Any = None

    @classmethod
    async def begin(cls, client: Any, **options: Any) -> RawSftp:
        raw = cls()

        class Session(asyncssh.SSHClientSession):  # type: ignore[misc]
            def data_received(self, data: bytes, datatype: Any) -> None:
                raw.data += data

        raw.channel, _ = await client.create_session(Session, subsystem="sftp", encoding=None, **options)
        return raw

    @property
    def answers(self) -> list[int]:
        """Kinds of the answers that have come."""
        kinds, at = [], 0
        while at + 4 <= len(self.data) and at + 4 + (size := int.from_bytes(self.data[at : at + 4])) <= len(self.data):
            kinds.append(self.data[at + 4])
            at += 4 + size
        return kinds


FLOODS = {
    "FSETSTAT": packet(10, HANDLE + bytes(4)),
    "FSETSTAT of no handle": packet(10, text(b"none") + bytes(4)),
    "STAT": packet(17, text(LOG.encode())),
    "REALPATH": packet(16, text(b"/a/../b")),
    "WRITE": packet(6, HANDLE + bytes(8) + text(b"x")),
    "OPENDIR": packet(11, text(b"/")),
    "no request": packet(99, b""),
    "copy-data": packet(200, text(b"copy-data") + HANDLE + bytes(16) + HANDLE + bytes(8)),
}


@pytest.mark.parametrize("request_", FLOODS.values(), ids=FLOODS.keys())
def test_requests_of_one_client_are_carried_out_within_its_share(
    request_: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A clock that every look at it advances by a sixth of a share: 60 requests take more than a few ticks."""

    async def scene() -> None:
        async with hosted() as host, host.connect() as client:
            raw = await RawSftp.begin(client)
            raw.channel.write(INIT + OPEN)
            await host.scene.until(lambda: raw.answers == [2, 102])
            at = [0]
            monkeypatch.setattr(turns, "time", SimpleNamespace(thread_time_ns=lambda: at.append(0) or len(at) * 50_000))
            first = host.scene.server.output.tick
            raw.channel.write(request_ * 60)
            await host.scene.until(lambda: len(raw.answers) == 62)
            assert host.scene.server.output.tick - first >= 3

    run(scene())


class TestBounds:
    def test_answers_that_are_not_taken_hold_further_requests_up(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                raw = await RawSftp.begin(client, window=2**31 - 1)
                raw.channel.write(INIT + OPEN + packet(6, HANDLE + bytes(8) + text(bytes(2**15))))
                await host.scene.until(lambda: len(raw.answers) == 3)
                client._transport.pause_reading()
                raw.channel.write(packet(5, HANDLE + bytes(8) + (2**22).to_bytes(4)) * 600)
                (served,) = host.desk.listener.clients.values()
                await host.scene.until(lambda: served.is_behind)
                await host.scene.ticks(20)
                assert served._transport.get_write_buffer_size() < 2**19
                client._transport.resume_reading()
                await host.scene.until(lambda: len(raw.answers) > 40)

        run(scene())

    def test_sessions_of_a_client_are_bounded(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client, host.connect() as other:
                held = [await RawSftp.begin(client) for _ in range(ssh_server.SESSIONS_MAX)]
                with pytest.raises(asyncssh.ChannelOpenError, match="4 sessions are open"):
                    await client.run("printenv PATH")
                assert (await other.run("printenv PATH")).exit_status == 0
                held[0].channel.write(INIT)
                await host.scene.until(lambda: held[0].answers == [2])
                held[0].channel.close()
                await held[0].channel.wait_closed()
                assert (await client.run("printenv PATH")).exit_status == 0

        run(scene())

    def test_open_files_and_listings_of_a_client_are_bounded_and_others_have_theirs(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client, host.connect() as other:
                raw = await RawSftp.begin(client)
                many = ssh_server.OPEN_MAX + 3
                raw.channel.write(INIT + OPEN * many + packet(11, text(b"/")) * many)
                await host.scene.until(lambda: len(raw.answers) == 1 + 2 * many)
                handles = raw.answers.count(102)
                assert handles == 2 * ssh_server.OPEN_MAX
                raw.channel.write(packet(4, text((many + 5).to_bytes(4))) + packet(11, text(b"/")))
                async with other.start_sftp_client() as sftp:
                    assert "tmp" in await sftp.listdir("/")
                    async with sftp.open("/tmp/y", "w") as file:
                        await file.write("x")

        run(scene())

    def test_environment_variables_are_forgotten(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                done = await client.run("printenv PATH", env={f"NAME{number}": "x" * 1000 for number in range(50)})
                assert done.exit_status == 0

        run(scene())

    def test_clients_that_do_not_log_in_take_no_place_of_those_that_do(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                strangers = [await asyncio.open_connection("127.0.0.1", host.number) for _ in range(GUESTS_MAX + 8)]
                async with host.connect() as other:
                    assert (await other.run("printenv PATH")).exit_status == 0
                assert (await client.run("printenv PATH")).exit_status == 0
                assert len(host.desk.listener.clients) <= GUESTS_MAX + 2
                (line,) = host.said
                assert line.startswith("ssh: closed ssh#2 from 127.0.0.1:")
                assert line.endswith(": 32 clients have not logged in")
                for _, writer in strangers:
                    writer.close()

        run(scene())

    def test_tasks_of_the_library_are_charged_to_their_client(self) -> None:
        async def scene() -> None:
            async with hosted() as host, host.connect() as client:
                (served,) = host.desk.listener.clients.values()
                before = served.connection.turns.steps
                assert before > 3
                await client.run("printenv PATH")
                assert served.connection.turns.steps > before

        run(scene())


HARMLESS = {
    "channel",
    "connection",
    "convert_attrs",
    "env",
    "format_longname",
    "logger",
}
"""Members of the library's file server that reach no file."""


def test_no_method_of_the_library_that_reaches_files_of_this_computer_is_left() -> None:
    public = {name for name, _ in inspect.getmembers(asyncssh.SFTPServer) if not name.startswith("_")}
    replaced = {name for name in vars(ssh_server._Sftp) if not name.startswith("_")}
    assert public - replaced == HARMLESS
