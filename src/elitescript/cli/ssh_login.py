"""The login at the SSH port of `serve`, from the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from elitescript.errors import UsageError
from elitescript.extras import require
from elitescript.records import NamedTuple

if TYPE_CHECKING:
    import argparse

PASSWORD_MAX: Final = 256
"""Characters."""
RANDOM_BYTES: Final = 12


class Login(NamedTuple):
    """Name and password of the only user."""

    user: str
    password: str
    is_random: bool
    """Whether it was generated, so that it must be printed."""


def ssh_login(options: argparse.Namespace) -> Login | None:
    """Return the login of the options; None without `--ssh`.

    Raises:
        UsageError: the extra is missing, or the password is invalid.
    """
    if not options.ssh:
        if options.ssh_password is not None:
            raise UsageError("--ssh-password does nothing without --ssh")
        return None
    require("ssh")
    given: str | None = options.ssh_password
    if given is None:
        from secrets import token_urlsafe

        return Login("root", token_urlsafe(RANDOM_BYTES), is_random=True)
    return Login("root", checked_password(given), is_random=False)


def checked_password(given: str) -> str:
    """Return the password of `--ssh-password`: the text itself, or the first line of the file behind `@`.

    Raises:
        UsageError: the file cannot be read, or this is no password.
    """
    password = _read(given[1:]) if given.startswith("@") else given
    if not password or len(password) > PASSWORD_MAX or not password.isprintable():
        raise UsageError(f"--ssh-password: 1 to {PASSWORD_MAX} printable characters are a password")
    return password


def _read(name: str) -> str:
    from elitescript.untrusted.files import PASSWORD, read_text

    return read_text(name, PASSWORD, is_stream_allowed=True).rstrip("\r\n")
