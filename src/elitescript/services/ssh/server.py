"""The SSH port of a robot. Everything that a client can reach is in memory: no shell, no file of this computer.

Sockets are read and written as those of every other port are (`services.clients`); the library gets bytes through
`connection`. What one client has at once is bounded: sessions, open files, listings, bytes that wait for it.

The only module that imports asyncssh, which is the extra `ssh`; nothing imports this one before `serve --ssh` does.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import hmac
import posixpath
import stat
import weakref
from collections.abc import Callable
from hashlib import sha256
from typing import Any, Final

import asyncssh

from elitescript.errors import UsageError
from elitescript.services.ssh import commands as ssh_commands
from elitescript.services.ssh.commands import FindBridge, Kill, Refuse, Say, StartBridge, read_command
from elitescript.services.ssh.connection import SshConnection
from elitescript.services.ssh.files import BYTES_MAX, OpenFile, RobotFiles, Status, absolute
from elitescript.services.ssh.serial_bridges import SerialBridges

USER: Final = "root"
"""The only one (*assumed*)."""
CLIENTS_MAX: Final = 8
"""That have logged in; those that have not are bounded by `listener.GUESTS_MAX`."""
SESSIONS_MAX: Final = 4
"""Of one client at once: commands, SFTP, SCP."""
OPEN_MAX: Final = 16
"""Files, and as many listings of folders, that one client has open at once."""
READ_MAX: Final = 256 * 1024
"""Bytes that one request reads; copies within the robot are made of pieces of this size."""
ATTEMPTS_MAX: Final = 3
"""Passwords of one connection."""
WRONG_PASSWORD_S: Final = 1.0
"""How long the answer to a wrong password takes."""
LOGIN_S: Final = 20
"""A client that has not logged in by then is let go."""
WINDOW: Final = 64 * 1024
"""Bytes of a channel that may wait to be read: few, so that a transfer does not hold up a tick for long."""
PACKET_MAX: Final = 4 * 1024 * 1024 + 1024
"""Bytes of an SFTP request: as many as the library tells clients."""
CONNECTION: Final = "elitescript_connection"
"""What the library knows a connection's `SshConnection` by."""
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

    __slots__ = (
        "_acceptor",
        "_bridges",
        "_clients",
        "_files",
        "_key",
        "_make",
        "_password",
        "_warn",
        "_wrong_password_s",
    )

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
        self._clients: set[_Login] = set()
        self._acceptor: Any = None
        self._make: Callable[[str, int], Any]

    @property
    def fingerprint(self) -> str:
        """Of the host key, as clients show it."""
        return str(self._key.get_fingerprint())

    async def open(self) -> None:
        """Prepare the library for clients."""
        # What it takes for a connection that carries its connections gets their factory, and nothing listens.
        self._acceptor = await asyncssh.listen(
            tunnel=self,
            config=None,
            server_factory=lambda: _Login(self),
            server_host_keys=[self._key],
            password_auth=True,
            public_key_auth=False,
            kbdint_auth=False,
            host_based_auth=False,
            gss_host=None,
            allow_pty=False,
            agent_forwarding=False,
            x11_forwarding=False,
            compression_algs=None,
            kex_algs=list(KEY_EXCHANGES),
            login_timeout=LOGIN_S,
        )

    async def create_server(self, factory: Callable[[str, int], Any], host: str, port: int) -> SshPort:
        """Keep what makes the library's end of a connection; called by the library."""
        self._make = factory
        return self

    def set_tunnel(self, tunnel: SshPort) -> None:
        """Do nothing; called by the library."""

    def close(self) -> None:
        """Do nothing: clients are let go by the listener."""

    def make_protocol(self, connection: SshConnection) -> Any:
        """Return the library's end of a connection; `_Login` finds the connection in it."""
        protocol = self._make("", 0)
        protocol.set_extra_info(**{CONNECTION: connection})
        return protocol

    # ---------------------------------------------------------------- called by connections

    def enter(self, login: _Login) -> bool:
        """Count a client that logs in; return whether there is room for it."""
        if len(self._clients) >= CLIENTS_MAX:
            self._warn(f"ssh: a client is refused, {CLIENTS_MAX} have logged in")
            return False
        self._clients.add(login)
        return True

    def leave(self, login: _Login) -> None:
        """Forget a client that has gone."""
        self._clients.discard(login)

    def session(self, login: _Login) -> Any:
        """Return a session of a client."""
        return _Session(login, self._run, lambda channel: _Sftp(channel, self._files, login))

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
            process.stderr.write(f"elitescript: there is no {what} here.\n".encode(errors="backslashreplace"))
            process.exit(ssh_commands.NO_SUCH_COMMAND)
            return
        text, problem, status = await self._answer(command)
        process.stdout.write(text.encode(errors="backslashreplace"))
        process.stderr.write(problem.encode(errors="backslashreplace"))
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
    """One client. What it does not answer itself (forwarding, other ways to log in) the library refuses."""

    __slots__ = ("_attempts", "_library", "_port", "connection", "listings", "opened", "sessions")

    def __init__(self, port: SshPort) -> None:
        self._port = port
        self._library: Any = None
        self.connection: SshConnection
        self._attempts = self.sessions = self.opened = 0
        self.listings: weakref.WeakSet[_Listing] = weakref.WeakSet()
        """Of folders, that the client has not closed."""

    def connection_made(self, conn: Any) -> None:
        self._library = conn
        self.connection = conn.get_extra_info(CONNECTION)

    def connection_lost(self, exc: Exception | None) -> None:
        self._port.leave(self)

    def begin_auth(self, username: str) -> bool:
        self.connection.stage = max(self.connection.stage, 2)
        return True

    def password_auth_supported(self) -> bool:
        return True

    async def validate_password(self, username: str, password: str) -> bool:
        self._attempts += 1
        if await self._port.admits(username, password):
            if not self._port.enter(self):
                reason = f"{CLIENTS_MAX} clients have logged in"
                raise asyncssh.DisconnectError(asyncssh.DISC_TOO_MANY_CONNECTIONS, reason)
            self.connection.stage = SshConnection.ADMITTED
            return True
        if self._attempts >= ATTEMPTS_MAX:
            self._library.abort()
        return False

    def session_requested(self) -> Any:
        if self.sessions >= SESSIONS_MAX:
            raise asyncssh.ChannelOpenError(asyncssh.OPEN_RESOURCE_SHORTAGE, f"{SESSIONS_MAX} sessions are open")
        channel = self._library.create_server_channel(encoding=None, window=WINDOW)
        channel._env = _Nothing()
        return channel, self._port.session(self)

    def take(self) -> None:
        """Count a file that is opened.

        Raises:
            OSError: the client has too many.
        """
        if self.opened >= OPEN_MAX:
            raise OSError(errno.EMFILE, f"a client has {OPEN_MAX} files open at most")
        self.opened += 1


class _Nothing(dict[bytes, bytes]):
    """Keeps no environment variables: nothing reads them, and a client may send any number."""

    def __setitem__(self, key: bytes, value: bytes) -> None:
        """Forget it."""


class _Session(asyncssh.SSHServerProcess[bytes]):
    """One session of a client. Its requests are read one by one, each when the client's share allows it."""

    def __init__(self, login: _Login, run: Callable[[Any], Any], make_files: Callable[[Any], Any]) -> None:
        super().__init__(run, make_files, sftp_version=3, allow_scp=True)
        self._login = login

    def connection_made(self, chan: Any) -> None:
        self._login.sessions += 1
        super().connection_made(chan)

    def connection_lost(self, exc: Exception | None) -> None:
        self._login.sessions -= 1
        super().connection_lost(exc)

    async def read(self, datatype: Any, n: int, exact: bool) -> Any:
        if n > PACKET_MAX:
            raise asyncssh.SFTPBadMessage(f"a request has {PACKET_MAX} bytes at most")
        # What was answered before is to be taken first.
        await self.drain(None)
        await self._login.connection.turns.next()
        return await super().read(datatype, n, exact)


class _Listing:
    """The entries of a folder, as they were when it was opened.

    Args:
        files: of the robot.
        folder: its path.
    """

    __slots__ = ("__weakref__", "_files", "_folder", "_names")

    def __init__(self, files: RobotFiles, folder: str) -> None:
        self._files = files
        self._folder = folder
        self._names = iter((".", "..", *files.names(folder)))

    def __aiter__(self) -> _Listing:
        return self

    async def __anext__(self) -> Any:
        for name in self._names:
            # An entry may have been removed since.
            with contextlib.suppress(FileNotFoundError):
                attributes = _attributes(self._files.status(posixpath.join(self._folder, name)))
                return asyncssh.SFTPName(name.encode(errors="surrogateescape"), attrs=attributes)
        raise StopAsyncIteration


class _Sftp(asyncssh.SFTPServer):
    """The files of a robot for SFTP and SCP.

    Every method of the base class that would reach the file system of this computer is replaced; the tests hold this
    for those that later versions of the library may add.
    """

    def __init__(self, channel: Any, files: RobotFiles, login: _Login) -> None:
        super().__init__(channel)
        self._files = files
        self._login = login

    def format_user(self, uid: int | None) -> str:
        return USER

    def format_group(self, gid: int | None) -> str:
        return USER

    def map_path(self, path: bytes) -> bytes:
        return path

    def reverse_map_path(self, path: bytes) -> bytes:
        return path

    def open(self, path: bytes, pflags: int, attrs: Any) -> OpenFile:
        self._login.take()
        try:
            return self._opened(path, pflags)
        except OSError:
            self._login.opened -= 1
            raise

    def _opened(self, path: bytes, pflags: int) -> OpenFile:
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
        self._login.opened -= 1
        _opened(file_obj).close()

    async def read(self, file_obj: object, offset: int, size: int) -> bytes:
        # One request may read and write without end: a copy within the robot.
        await self._login.connection.turns.next()
        return _opened(file_obj).read(offset, min(size, READ_MAX))

    async def write(self, file_obj: object, offset: int, data: bytes) -> int:
        return _opened(file_obj).write(offset, data)

    def stat(self, path: bytes) -> Any:
        return _attributes(self._files.status(_text(path)))

    def lstat(self, path: bytes) -> Any:
        return self.stat(path)

    def fstat(self, file_obj: object) -> Any:
        return _attributes(_opened(file_obj).status)

    def setstat(self, path: bytes, attrs: Any) -> None:
        """Set the size and the time of the last change; owners and modes stay as they are, and so do folders."""
        status = self._files.status(_text(path))
        if status.is_folder or (attrs.size is None and attrs.mtime is None):
            return
        file = self._files.open(_text(path), writes=True)
        try:
            _set(file, attrs)
        finally:
            file.close()

    def lsetstat(self, path: bytes, attrs: Any) -> None:
        self.setstat(path, attrs)

    def fsetstat(self, file_obj: object, attrs: Any) -> None:
        _set(_opened(file_obj), attrs)

    def scandir(self, path: bytes) -> _Listing:
        listings = self._login.listings
        if len(listings) >= OPEN_MAX:
            raise OSError(errno.EMFILE, f"a client has {OPEN_MAX} folders open at most")
        listing = _Listing(self._files, _text(path))
        listings.add(listing)
        return listing

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


def _set(file: OpenFile, attrs: Any) -> None:
    """Set what a client asks for; the time last, which a change of the size sets too."""
    if attrs.size is not None:
        file.truncate(attrs.size)
    if attrs.mtime is not None:
        file.set_time(int(attrs.mtime))


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
