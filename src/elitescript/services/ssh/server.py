"""The SSH port of a robot. Everything that a client can reach is in memory: no shell, no file of this computer.

The only module that imports asyncssh, which is the extra `ssh`; nothing imports this one before `serve --ssh` does.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import hmac
import posixpath
import socket
import stat
from collections.abc import AsyncIterator, Callable
from hashlib import sha256
from typing import Any, Final

import asyncssh

from elitescript.errors import UsageError
from elitescript.services.clients.liveness import watch_peer
from elitescript.services.ssh import commands as ssh_commands
from elitescript.services.ssh.commands import FindBridge, Kill, Refuse, Say, StartBridge, read_command
from elitescript.services.ssh.files import BYTES_MAX, OpenFile, RobotFiles, Status, absolute
from elitescript.services.ssh.serial_bridges import SerialBridges

USER: Final = "root"
"""The only one (*assumed*)."""
CONNECTIONS_MAX: Final = 8
ATTEMPTS_MAX: Final = 3
"""Passwords of one connection."""
WRONG_PASSWORD_S: Final = 1.0
"""How long the answer to a wrong password takes."""
LOGIN_S: Final = 20
"""A client that has not logged in by then is let go."""
WINDOW: Final = 64 * 1024
"""Bytes of a channel that may wait to be read: few, so that a transfer does not hold up a tick for long."""
KEY_EXCHANGES: Final = ("curve25519-sha256", "curve25519-sha256@libssh.org", "ecdh-sha2-nistp256")
"""Those that keep the process busy for less than a tick."""

Warn = Callable[[str], None]


class SshPort:
    """Logs clients in and does what they ask.

    The host key is made anew for each server and is nowhere but in memory: a later server is another host for a
    client that remembers keys.

    Args:
        password: of `USER`.
        files: that clients see.
        bridges: that clients start and end.
        warn: takes a line for the log.
        wrong_password_s: how long the answer to a wrong password takes.
    """

    __slots__ = ("_acceptor", "_bridges", "_connections", "_files", "_key", "_password", "_warn", "_wrong_password_s")

    def __init__(
        self,
        password: str,
        files: RobotFiles,
        bridges: SerialBridges,
        warn: Warn,
        *,
        wrong_password_s: float = WRONG_PASSWORD_S,
    ) -> None:
        self._password = password
        self._files = files
        self._bridges = bridges
        self._warn = warn
        self._wrong_password_s = wrong_password_s
        self._key = asyncssh.generate_private_key("ssh-ed25519")
        self._connections: set[_Login] = set()
        self._acceptor: Any = None

    @property
    def fingerprint(self) -> str:
        """Of the host key, as clients show it."""
        return str(self._key.get_fingerprint())

    async def open(self, bound: socket.socket) -> None:
        """Accept clients at a socket that listens; the port closes it."""
        self._acceptor = await asyncssh.listen(
            sock=bound,
            config=None,
            server_factory=lambda: _Login(self),
            server_host_keys=[self._key],
            process_factory=self._run,
            sftp_factory=lambda channel: _Sftp(channel, self._files),
            allow_scp=True,
            encoding=None,
            password_auth=True,
            public_key_auth=False,
            kbdint_auth=False,
            host_based_auth=False,
            gss_host=None,
            allow_pty=False,
            agent_forwarding=False,
            x11_forwarding=False,
            line_editor=False,
            compression_algs=None,
            kex_algs=list(KEY_EXCHANGES),
            login_timeout=LOGIN_S,
            window=WINDOW,
        )

    async def close(self) -> None:
        """Let every client go."""
        if self._acceptor is not None:
            self._acceptor.close()
            for login in list(self._connections):
                login.drop()
            with contextlib.suppress(OSError, asyncssh.Error):
                await self._acceptor.wait_closed()

    # ---------------------------------------------------------------- called by connections

    def enter(self, login: _Login) -> bool:
        """Count a connection; whether there is room for it."""
        if len(self._connections) >= CONNECTIONS_MAX:
            self._warn(f"ssh: a client is refused, {CONNECTIONS_MAX} are connected")
            return False
        self._connections.add(login)
        return True

    def leave(self, login: _Login) -> None:
        """Forget a connection that has gone."""
        self._connections.discard(login)

    async def admits(self, user: str, password: str) -> bool:
        """Return whether a login is right; takes the same time whatever is wrong."""
        given, wanted = (sha256(text.encode(errors="replace")).digest() for text in (password, self._password))
        is_right = hmac.compare_digest(given, wanted) & (user == USER)
        if not is_right:
            self._warn("ssh: a login with a wrong user name or password is refused")
            await asyncio.sleep(self._wrong_password_s)
        return is_right

    async def _run(self, process: Any) -> None:
        """Answer the command of a client; one that asks for a shell gets a text."""
        command = process.command
        if command is None:
            what = f"subsystem {process.subsystem!r}" if process.subsystem else "shell"
            process.stderr.write(f"elitescript: there is no {what} here.\n".encode(errors="replace"))
            process.exit(ssh_commands.NO_SUCH_COMMAND)
            return
        text, problem, status = await self._answer(command)
        process.stdout.write(text.encode())
        process.stderr.write(problem.encode(errors="replace"))
        process.exit(status)

    async def _answer(self, command: str) -> tuple[str, str, int]:
        """Output, error text and exit status of a command."""
        match read_command(command):
            case Say(text):
                return text, "", 0
            case FindBridge(port):
                number = self._bridges.find(port)
                return (f"{number}\n" if number else ""), "", 0
            case StartBridge(port, device):
                try:
                    await self._bridges.start(port, device)
                except UsageError as error:
                    self._warn(f"ssh: {error}")
                    return "", f"elitescript: {error}\n", 1
                return "", "", 0
            case Kill(number):
                is_done = self._bridges.kill(number)
                return "", "" if is_done else f"elitescript: {number} is no bridge\n", 0 if is_done else 1
            case Refuse(text):
                return "", text, ssh_commands.NO_SUCH_COMMAND


class _Login(asyncssh.SSHServer):
    """One connection. What it does not answer itself (forwarding, other ways to log in) the library refuses."""

    __slots__ = ("_attempts", "_connection", "_port")

    def __init__(self, port: SshPort) -> None:
        self._port = port
        self._connection: Any = None
        self._attempts = 0

    def connection_made(self, conn: Any) -> None:
        self._connection = conn
        raw = conn.get_extra_info("socket")
        if raw is not None:
            watch_peer(raw)
        if not self._port.enter(self):
            conn.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        self._port.leave(self)

    def begin_auth(self, username: str) -> bool:
        return True

    def password_auth_supported(self) -> bool:
        return True

    async def validate_password(self, username: str, password: str) -> bool:
        self._attempts += 1
        if await self._port.admits(username, password):
            return True
        if self._attempts >= ATTEMPTS_MAX:
            self.drop()
        return False

    def drop(self) -> None:
        """Close at once."""
        self._connection.abort()


class _Sftp(asyncssh.SFTPServer):
    """The files of a robot for SFTP and SCP.

    Every method of the base class that would reach the file system of this computer is replaced; the tests hold this
    for those that later versions of the library may add.
    """

    def __init__(self, channel: Any, files: RobotFiles) -> None:
        super().__init__(channel)
        self._files = files

    def format_user(self, uid: int | None) -> str:
        return USER

    def format_group(self, gid: int | None) -> str:
        return USER

    def map_path(self, path: bytes) -> bytes:
        return path

    def reverse_map_path(self, path: bytes) -> bytes:
        return path

    def open(self, path: bytes, pflags: int, attrs: Any) -> OpenFile:
        return self._files.open(
            _text(path),
            writes=bool(pflags & asyncssh.FXF_WRITE),
            appends=bool(pflags & asyncssh.FXF_APPEND),
            creates=bool(pflags & asyncssh.FXF_CREAT),
            truncates=bool(pflags & asyncssh.FXF_TRUNC),
            is_new=bool(pflags & asyncssh.FXF_EXCL),
        )

    def open56(self, path: bytes, desired_access: int, flags: int, attrs: Any) -> OpenFile:
        # Of a later version of SFTP than is offered.
        raise _unsupported()

    def close(self, file_obj: object) -> None:
        _opened(file_obj).close()

    def read(self, file_obj: object, offset: int, size: int) -> bytes:
        return _opened(file_obj).read(offset, size)

    def write(self, file_obj: object, offset: int, data: bytes) -> int:
        return _opened(file_obj).write(offset, data)

    def stat(self, path: bytes) -> Any:
        return _attributes(self._files.status(_text(path)))

    def lstat(self, path: bytes) -> Any:
        return self.stat(path)

    def fstat(self, file_obj: object) -> Any:
        return _attributes(_opened(file_obj).status)

    def setstat(self, path: bytes, attrs: Any) -> None:
        """Set the size; owners, modes and times stay as they are."""
        if attrs.size is None:
            self._files.status(_text(path))
            return
        file = self._files.open(_text(path), writes=True)
        try:
            file.truncate(attrs.size)
        finally:
            file.close()

    def lsetstat(self, path: bytes, attrs: Any) -> None:
        self.setstat(path, attrs)

    def fsetstat(self, file_obj: object, attrs: Any) -> None:
        if attrs.size is not None:
            _opened(file_obj).truncate(attrs.size)

    async def scandir(self, path: bytes) -> AsyncIterator[Any]:
        folder = _text(path)
        for name in (".", "..", *self._files.names(folder)):
            status = self._files.status(posixpath.join(folder, name))
            encoded = name.encode(errors="surrogateescape")
            yield asyncssh.SFTPName(encoded, attrs=_attributes(status))

    def remove(self, path: bytes) -> None:
        self._files.remove(_text(path))

    def mkdir(self, path: bytes, attrs: Any) -> None:
        self._files.make_folder(_text(path))

    def rmdir(self, path: bytes) -> None:
        self._files.remove_folder(_text(path))

    def realpath(self, path: bytes) -> bytes:
        return absolute(_text(path)).encode(errors="surrogateescape")

    def rename(self, oldpath: bytes, newpath: bytes) -> None:
        self._files.rename(_text(oldpath), _text(newpath), replaces=False)

    def posix_rename(self, oldpath: bytes, newpath: bytes) -> None:
        self._files.rename(_text(oldpath), _text(newpath), replaces=True)

    def readlink(self, path: bytes) -> bytes:
        raise _unsupported()

    def symlink(self, oldpath: bytes, newpath: bytes) -> None:
        raise _unsupported()

    def link(self, oldpath: bytes, newpath: bytes) -> None:
        raise _unsupported()

    def lock(self, file_obj: object, offset: int, length: int, flags: int) -> None:
        raise _unsupported()

    def unlock(self, file_obj: object, offset: int, length: int) -> None:
        raise _unsupported()

    def statvfs(self, path: bytes) -> Any:
        self._files.status(_text(path))
        return self._space()

    def fstatvfs(self, file_obj: object) -> Any:
        return self._space()

    def fsync(self, file_obj: object) -> None:
        """Files are in memory: nothing to do."""

    def exit(self) -> None:
        """End the session with status 0, without which `scp` reports a failure."""
        if not self.channel.is_closing():
            with contextlib.suppress(OSError):
                self.channel.exit(0)

    def _space(self) -> Any:
        blocks, free = BYTES_MAX // 4096, self._files.free // 4096
        return asyncssh.SFTPVFSAttrs(
            bsize=4096, frsize=4096, blocks=blocks, bfree=free, bavail=free, files=0, ffree=0, favail=0, fsid=0
        )


def _opened(file_obj: object) -> OpenFile:
    assert isinstance(file_obj, OpenFile)
    return file_obj


def _text(path: bytes) -> str:
    return path.decode(errors="surrogateescape")


def _attributes(status: Status) -> Any:
    kind = stat.S_IFDIR if status.is_folder else stat.S_IFREG
    file_type = asyncssh.FILEXFER_TYPE_DIRECTORY if status.is_folder else asyncssh.FILEXFER_TYPE_REGULAR
    return asyncssh.SFTPAttrs(
        type=file_type,
        size=status.size,
        uid=0,
        gid=0,
        permissions=kind | status.mode,
        atime=status.time_s,
        mtime=status.time_s,
        nlink=1,
    )


def _unsupported() -> OSError:
    return OSError(errno.EOPNOTSUPP, "the robot's files have neither links nor locks")
