"""A program from the disk of a controller, over SFTP: none of its other ports gives the text of one.

The file is read, and nothing else is done there. The key of the controller has to be known to this computer, as for
`ssh`, since the password of its only user (*assumed*: root) goes to whom it connects to.
"""

from __future__ import annotations

import asyncio
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.extras import require

USER: Final = "root"
LONGEST_S: Final = 10.0
SIZE_MAX: Final = 16 << 20
"""Bytes of a program; more is none."""


def fetch_program(host: str, port: int, password: str, path: str, known_hosts: Any = ()) -> bytes:
    """Return a file of a controller.

    Args:
        host: of the controller.
        port: of SSH.
        password: of `USER`.
        path: of the file there.
        known_hosts: as `asyncssh.connect` takes it; by default the user's own file.

    Raises:
        UsageError: the extra is missing, there is no SSH port, its key is not known, the login is refused, or there is
            no such file. Says which.
    """
    require("ssh", "--fetch-program")
    import asyncssh

    where = f"SSH port {host}:{port}"
    try:
        return asyncio.run(asyncio.wait_for(_read(host, port, password, path, known_hosts), LONGEST_S))
    except TimeoutError:
        reason = f"{where}: no answer within {LONGEST_S:g} s"
    except asyncssh.HostKeyNotVerifiable:
        reason = f"{where}: its key is not known here; `ssh -p {port} {USER}@{host}` shows it and remembers it"
    except asyncssh.PermissionDenied:
        reason = f"{where}: the password of {USER} is refused"
    except asyncssh.SFTPError as error:
        reason = f"{where}: {path}: {error.reason}"
    except (OSError, asyncssh.Error) as error:
        reason = f"{where}: {getattr(error, 'strerror', None) or error}"
    raise UsageError(f"the program cannot be fetched ({reason}); name its file with --program")


async def _read(host: str, port: int, password: str, path: str, known_hosts: Any) -> bytes:
    import asyncssh

    async with (
        asyncssh.connect(
            host,
            port,
            username=USER,
            password=password,
            known_hosts=known_hosts,
            client_keys=None,
            config=None,
            agent_path=None,
        ) as connection,
        connection.start_sftp_client() as files,
        files.open(path, "rb") as file,
    ):
        data: bytes = await file.read(SIZE_MAX + 1)
    if len(data) > SIZE_MAX:
        raise UsageError(f"{path} of {host} has more than {SIZE_MAX >> 20} MiB: that is no program")
    return data
