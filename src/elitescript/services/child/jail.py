"""Locks a process that runs untrusted programs in, by means of its operating system, before any of them is compiled.

Every layer works by itself, so that a hole in one of them is not a way out:

    limits         memory, open files, no file may grow, no new processes, no core files
    capabilities   what a superuser may do is given up
    privileges     none can be won; no process of the same user can look into this one; it ends with its parent
    files          Landlock: nothing but the interpreter's own modules can be read, nothing written; no TCP; no signals
                   or abstract sockets to others
    system calls   seccomp: an allow-list (`syscalls`)

There is no limit on computing: the parent notices a process that does not answer.

Left open: the time of one processor core, whether a file exists, timing, and mistakes of the kernel.

Evidence: *measured* with the actions of `tests/services/hostile.py`.
"""

from __future__ import annotations

import ctypes
import os
import struct
import sys
from collections.abc import Callable, Iterable, Sequence
from typing import Final

from elitescript.records import NamedTuple
from elitescript.services.child import syscalls

MEMORY_MAX: Final = 1 << 30
"""Bytes of address space; a controller with a program takes a tenth."""
OPEN_FILES_MAX: Final = 32
OPEN_FILES_OF_COPIES_MAX: Final = 128
"""Of a process that talks to copies of itself, or to other computers."""

_NAMES: Final = tuple(
    f"/etc/{name}"
    for name in ("hosts", "resolv.conf", "nsswitch.conf", "host.conf", "gai.conf", "services", "protocols")
)
"""What is read to look the name of a computer up."""

_PR_SET_PDEATHSIG: Final = 1
_PR_SET_DUMPABLE: Final = 4
_PR_SET_SECCOMP: Final = 22
_PR_SET_NO_NEW_PRIVS: Final = 38
_PR_CAP_AMBIENT: Final = 47
_PR_CAP_AMBIENT_CLEAR_ALL: Final = 4
_SIGKILL: Final = 9
_SECCOMP_MODE_FILTER: Final = 2
_CAPABILITY_VERSION_3: Final = 0x20080522

_LANDLOCK_CREATE: Final = 444
_LANDLOCK_ADD_RULE: Final = 445
_LANDLOCK_RESTRICT: Final = 446
_LANDLOCK_FILE_RIGHTS: Final = {1: 0x1FFF, 2: 0x3FFF, 3: 0x7FFF, 4: 0x7FFF, 5: 0xFFFF}
"""All file rights by version; later versions have those of 5."""
_LANDLOCK_TCP: Final = 0x3
_LANDLOCK_BIND_TCP: Final = 0x1
_LANDLOCK_SCOPES: Final = 0x3
_READ_FILE: Final = 1 << 2
_READ_FOLDER: Final = 1 << 3


class Layer(NamedTuple):
    """One layer of the jail, and whether it is there."""

    name: str
    is_active: bool
    detail: str
    """What it does here, or why it is not there."""


def enter_jail(
    readable: Iterable[str] | None = None,
    memory_max: int = MEMORY_MAX,
    *,
    may_copy: bool = False,
    may_connect: bool = False,
) -> tuple[Layer, ...]:
    """Lock this process in, for good.

    Args:
        readable: files and folders that may still be read; `own_modules()` if None.
        memory_max: bytes of address space.
        may_copy: whether it may leave copies of itself, which are locked in as well.
        may_connect: whether it may open connections to other computers, and look their names up; instead of copies.

    Returns:
        Every layer: one that cannot be had is marked as missing, the others are there all the same.
    """
    paths = own_modules() if readable is None else list(readable)
    if may_connect:
        paths += [path for path in _NAMES if os.path.exists(path)]  # noqa: PTH110
    calls = syscalls.allowed(may_copy=may_copy, may_connect=may_connect)
    return (
        _tried("limits", lambda: _limit(memory_max, may_copy=may_copy, may_connect=may_connect)),
        _tried("capabilities", _drop_capabilities),
        _tried("privileges", _give_up_privileges),
        _tried("files", lambda: _restrict_files(paths, may_connect=may_connect)),
        _tried("system calls", lambda: _filter_calls(calls)),
    )


def is_complete(layers: Iterable[Layer]) -> bool:
    """Return whether what is locked in can reach nothing: all layers are there."""
    found = tuple(layers)
    return bool(found) and all(layer.is_active for layer in found)


def own_modules() -> list[str]:
    """Return where the interpreter and this package load from, and nothing else."""
    import greenlet  # type: ignore[import-untyped]

    import elitescript

    modules = (os, ctypes, greenlet, elitescript)
    folders = [os.path.dirname(os.path.abspath(str(module.__file__))) for module in modules]  # noqa: PTH100, PTH120
    folders += [path for path in sys.path if path.endswith(("lib-dynload", ".zip"))]
    folders[1] = os.path.dirname(folders[1])  # noqa: PTH120
    libraries = ["/lib", "/lib64", "/usr/lib", "/usr/lib64", f"{sys.base_exec_prefix}/lib", "/etc/ld.so.cache"]
    devices = ["/usr/share/zoneinfo", "/etc/localtime", "/dev/null", "/dev/urandom"]
    return sorted({path for path in (*folders, *libraries, *devices) if os.path.exists(path)})  # noqa: PTH110


def _tried(name: str, apply: Callable[[], str]) -> Layer:
    if sys.platform != "linux" and name != "limits":
        return Layer(name, False, f"needs Linux, this is {sys.platform}")
    try:
        return Layer(name, True, apply())
    except (OSError, ValueError, AttributeError, ImportError) as error:
        return Layer(name, False, str(error) or type(error).__name__)


def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def _checked(result: int, what: str) -> int:
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{what}: {os.strerror(number)}")
    return result


def _prctl(option: int, argument: int, what: str, third: int = 0) -> None:
    prctl = _libc().prctl
    # Variadic: without types, the upper halves of the registers hold whatever they held.
    values = [ctypes.c_ulong(value) for value in (argument, third, 0, 0)]
    _checked(prctl(ctypes.c_int(option), *values), what)


def _limit(memory_max: int, *, may_copy: bool, may_connect: bool) -> str:
    import resource

    open_files = OPEN_FILES_OF_COPIES_MAX if may_copy or may_connect else OPEN_FILES_MAX
    wanted = {"AS": memory_max, "NOFILE": open_files, "FSIZE": 0, "CORE": 0, "MEMLOCK": 0, "MSGQUEUE": 0}
    if not (may_copy or may_connect):
        # It counts threads too.
        wanted["NPROC"] = 0
    for name, value in wanted.items():
        number = getattr(resource, f"RLIMIT_{name}", None)
        if number is not None:
            hard = resource.getrlimit(number)[1]
            limit = value if hard == resource.RLIM_INFINITY else min(value, hard)
            resource.setrlimit(number, (limit, limit))
    processes = "copies of itself" if may_copy else "no processes"
    return f"{memory_max >> 20} MiB of memory, {open_files} open files, no growing files, {processes}"


def _drop_capabilities() -> str:
    _prctl(_PR_CAP_AMBIENT, _PR_CAP_AMBIENT_CLEAR_ALL, "prctl(PR_CAP_AMBIENT)")
    header = ctypes.create_string_buffer(struct.pack("=Ii", _CAPABILITY_VERSION_3, 0))
    none = ctypes.create_string_buffer(24)
    _checked(_libc().capset(header, none), "capset")
    return "none are left"


def _give_up_privileges() -> str:
    parent = os.getppid()
    _prctl(_PR_SET_PDEATHSIG, _SIGKILL, "prctl(PR_SET_PDEATHSIG)")
    if os.getppid() != parent:
        # The parent ended in between; no signal of that comes any more.
        os._exit(1)
    _prctl(_PR_SET_NO_NEW_PRIVS, 1, "prctl(PR_SET_NO_NEW_PRIVS)")
    _prctl(_PR_SET_DUMPABLE, 0, "prctl(PR_SET_DUMPABLE)")
    return "none can be won, no tracing, ends with its parent"


def landlock_version() -> int:
    """Return the version of Landlock in this kernel.

    Raises:
        OSError: it has none, or it is switched off.
    """
    return _checked(_libc().syscall(_LANDLOCK_CREATE, None, ctypes.c_size_t(0), ctypes.c_uint(1)), "Landlock")


def _restrict_files(readable: list[str], *, may_connect: bool) -> str:
    version = landlock_version()
    rights = _LANDLOCK_FILE_RIGHTS[min(version, 5)]
    attributes = struct.pack("=Q", rights)
    if version >= 4:
        attributes += struct.pack("=Q", _LANDLOCK_BIND_TCP if may_connect else _LANDLOCK_TCP)
    if version >= 6:
        attributes += struct.pack("=Q", _LANDLOCK_SCOPES)
    libc = _libc()
    size = ctypes.c_size_t(len(attributes))
    ruleset = _checked(libc.syscall(_LANDLOCK_CREATE, attributes, size, ctypes.c_uint(0)), "landlock_create_ruleset")
    try:
        for path in readable:
            _allow_reading(libc, ruleset, path)
        _checked(libc.syscall(_LANDLOCK_RESTRICT, ruleset, ctypes.c_uint(0)), "landlock_restrict_self")
    finally:
        os.close(ruleset)
    network = "no TCP" if version >= 4 else "TCP not restricted by this version"
    if may_connect:
        network = "TCP to others"
    return f"Landlock {version}: {len(readable)} places can be read, none written; {network}"


def _allow_reading(libc: ctypes.CDLL, ruleset: int, path: str) -> None:
    place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    try:
        is_folder = os.path.isdir(path)  # noqa: PTH112
        rule = struct.pack("=Qi", _READ_FILE | _READ_FOLDER if is_folder else _READ_FILE, place)
        _checked(libc.syscall(_LANDLOCK_ADD_RULE, ruleset, 1, rule, ctypes.c_uint(0)), f"landlock_add_rule {path}")
    finally:
        os.close(place)


class _Program(ctypes.Structure):
    """`struct sock_fprog`."""

    _fields_ = (("length", ctypes.c_ushort), ("filter", ctypes.c_char_p))


def _filter_calls(calls: Sequence[syscalls.Syscall]) -> str:
    machine = os.uname().machine
    if machine not in syscalls.AUDIT_ARCHES:
        raise OSError(f"no table of system calls for {machine}, only for {', '.join(syscalls.AUDIT_ARCHES)}")
    program = syscalls.filter_program(machine, calls)
    code = ctypes.create_string_buffer(syscalls.packed(program))
    wanted = _Program(len(program), ctypes.cast(code, ctypes.c_char_p))
    # PR_SET_SECCOMP refuses without no_new_privs, so a failure of that layer is seen here too.
    result = _libc().prctl(
        ctypes.c_int(_PR_SET_SECCOMP), ctypes.c_ulong(_SECCOMP_MODE_FILTER), ctypes.byref(wanted), 0, 0
    )
    _checked(result, "prctl(PR_SET_SECCOMP)")
    return f"{len(calls)} of them on {machine}, all others refused"
