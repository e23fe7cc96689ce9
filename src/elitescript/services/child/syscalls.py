"""The system calls that a jailed process may make, and the filter program that refuses all others.

An allow-list: what is not named gets `EPERM`. It lets a Python process compute, read, write what is open already,
tell the time, load its own modules and end. It has no row that makes a process, a thread, a socket or a file, sends a
signal, traces, mounts, or raises a limit.

Evidence: numbers are those of Linux' own headers; *measured*: programs run on it unchanged.
"""

from __future__ import annotations

import errno
import struct
from collections.abc import Sequence
from typing import Final

from elitescript.records import NamedTuple


class Check(NamedTuple):
    """A condition on one argument of a call."""

    argument: int
    kind: str
    """`none_of` its bits are set, `not_all_of` its bits are set, it is `one_of` these values, or `one_of_low`: its
    lower half is, where the kernel ignores the upper one."""
    values: tuple[int, ...]


class Syscall(NamedTuple):
    """One allowed system call."""

    name: str
    x86_64: int | None
    aarch64: int | None
    checks: tuple[Check, ...] = ()
    """All of them hold, or the call is refused."""
    is_missing: bool = False
    """Whether it is answered as by a kernel that does not have it, for libraries that then call another one."""


_WRITES: Final = 0o1 | 0o2 | 0o100 | 0o1000 | 0o20000000
"""O_WRONLY, O_RDWR, O_CREAT, O_TRUNC and O_TMPFILE, the same on both processors."""
_WRITE_AND_EXECUTE: Final = (0x2 | 0x4,)
_TERMINAL_QUESTION: Final = (0x5401, 0x5451)
"""TCGETS, which is how Python asks whether a file is a terminal, and FIOCLEX."""
_DESCRIPTOR_FLAGS: Final = (1, 2, 3)
"""F_GETFD, F_SETFD, F_GETFL."""

# The most frequent first: the filter is read from the top.
CALLS: Final = (
    Syscall("read", 0, 63),
    Syscall("write", 1, 64),
    Syscall("futex", 202, 98),
    Syscall("clock_gettime", 228, 113),
    Syscall("mmap", 9, 222, (Check(2, "not_all_of", _WRITE_AND_EXECUTE),)),
    Syscall("munmap", 11, 215),
    Syscall("brk", 12, 214),
    Syscall("mremap", 25, 216),
    Syscall("madvise", 28, 233),
    Syscall("mprotect", 10, 226, (Check(2, "none_of", (0x4,)),)),
    Syscall("rt_sigprocmask", 14, 135),
    Syscall("rt_sigaction", 13, 134),
    Syscall("rt_sigreturn", 15, 139),
    Syscall("sigaltstack", 131, 132),
    Syscall("restart_syscall", 219, 128),
    Syscall("openat", 257, 56, (Check(2, "none_of", (_WRITES,)),)),
    Syscall("open", 2, None, (Check(1, "none_of", (_WRITES,)),)),
    Syscall("close", 3, 57),
    Syscall("newfstatat", 262, 79),
    Syscall("fstat", 5, 80),
    Syscall("statx", 332, 291),
    Syscall("stat", 4, None),
    Syscall("lstat", 6, None),
    Syscall("access", 21, None),
    Syscall("faccessat", 269, 48),
    Syscall("faccessat2", 439, 439),
    Syscall("readlink", 89, None),
    Syscall("readlinkat", 267, 78),
    Syscall("getcwd", 79, 17),
    Syscall("getdents64", 217, 61),
    Syscall("lseek", 8, 62),
    Syscall("readv", 19, 65),
    Syscall("writev", 20, 66),
    Syscall("pread64", 17, 67),
    Syscall("ioctl", 16, 29, (Check(1, "one_of", _TERMINAL_QUESTION),)),
    Syscall("fcntl", 72, 25, (Check(1, "one_of", _DESCRIPTOR_FLAGS),)),
    Syscall("poll", 7, None),
    Syscall("ppoll", 271, 73),
    Syscall("select", 23, None),
    Syscall("pselect6", 270, 72),
    Syscall("clock_getres", 229, 114),
    Syscall("clock_nanosleep", 230, 115),
    Syscall("nanosleep", 35, 101),
    Syscall("gettimeofday", 96, 169),
    Syscall("time", 201, None),
    Syscall("getrandom", 318, 278),
    Syscall("getpid", 39, 172),
    Syscall("gettid", 186, 178),
    Syscall("getppid", 110, 173),
    Syscall("getuid", 102, 174),
    Syscall("geteuid", 107, 175),
    Syscall("getgid", 104, 176),
    Syscall("getegid", 108, 177),
    Syscall("getrusage", 98, 165),
    Syscall("sysinfo", 99, 179),
    Syscall("uname", 63, 160),
    Syscall("sched_yield", 24, 124),
    Syscall("sched_getaffinity", 204, 123),
    Syscall("set_robust_list", 273, 99),
    Syscall("rseq", 334, 293),
    Syscall("membarrier", 324, 283),
    # Its own limits may be read, and none may be set.
    Syscall("prlimit64", 302, 261, (Check(0, "one_of", (0,)), Check(2, "one_of", (0,)))),
    Syscall("exit", 60, 93),
    Syscall("exit_group", 231, 94),
)

COPYING: Final = (
    # No flag for a namespace of its own.
    Syscall("clone", 56, 220, (Check(0, "none_of", (0x7E020000,)),)),
    Syscall("wait4", 61, 260),
    Syscall("socketpair", 53, 199, (Check(0, "one_of", (1,)), Check(1, "one_of", (0x1, 0x80001)))),
    Syscall("sendto", 44, 206),
    Syscall("recvfrom", 45, 207),
    Syscall("sendmsg", 46, 211),
    Syscall("recvmsg", 47, 212),
    Syscall("getsockname", 51, 204),
    Syscall("getsockopt", 55, 209),
)
"""What a process may do besides that leaves copies of itself and talks to them: through pairs of streams of this
computer (AF_UNIX), which are connected to each other and to nothing else."""

_STREAMS_AND_DATAGRAMS: Final = tuple(kind | flags for kind in (1, 2) for flags in (0, 0x800, 0x80000, 0x80800))
"""SOCK_STREAM and SOCK_DGRAM, with SOCK_NONBLOCK and SOCK_CLOEXEC."""
_THREAD_FLAGS: Final = (0x3D0F00, 0x7D0F00)
"""Of a thread, as C libraries make them: it shares memory, files and signals, and is no process."""

CONNECTING: Final = (
    Syscall("socket", 41, 198, (Check(0, "one_of_low", (2, 10)), Check(1, "one_of_low", _STREAMS_AND_DATAGRAMS))),
    Syscall("connect", 42, 203),
    Syscall("sendto", 44, 206),
    Syscall("recvfrom", 45, 207),
    Syscall("sendmsg", 46, 211),
    Syscall("sendmmsg", 307, 269),
    Syscall("recvmsg", 47, 212),
    Syscall("shutdown", 48, 210),
    Syscall("getsockname", 51, 204),
    Syscall("getpeername", 52, 205),
    Syscall("setsockopt", 54, 208),
    Syscall("getsockopt", 55, 209),
    # Besides: TIOCOUTQ and FIONREAD, what waits in a connection, and FIONBIO, whether calls wait.
    Syscall("ioctl", 16, 29, (Check(1, "one_of", (*_TERMINAL_QUESTION, 0x5411, 0x541B, 0x5421)),)),
    # Names are looked up in a thread. Newer libraries ask for it in a way that no filter can look into.
    Syscall("clone3", 435, 435, is_missing=True),
    Syscall("clone", 56, 220, (Check(0, "one_of", _THREAD_FLAGS),)),
)
"""What a process may do besides that connects to other computers, in place of rows of `CALLS` with the same name:
streams and datagrams of IPv4 and IPv6, which it begins itself. It can neither listen nor take a port of its choice,
has no raw sockets, and no sockets of this computer (AF_UNIX)."""


def allowed(*, may_copy: bool = False, may_connect: bool = False) -> tuple[Syscall, ...]:
    """Return the table of a process; see `COPYING` and `CONNECTING`."""
    more = CONNECTING if may_connect else COPYING if may_copy else ()
    names = {call.name for call in more}
    return (*(call for call in CALLS if call.name not in names), *more)


AUDIT_ARCHES: Final = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
"""Processors that the table knows, as the kernel numbers them."""

_LOAD: Final = 0x20
_AND: Final = 0x54
_JUMP_IF_EQUAL: Final = 0x15
_JUMP_IF_AT_LEAST: Final = 0x35
_JUMP_IF_BITS: Final = 0x45
_RETURN: Final = 0x06
_KILL_PROCESS: Final = 0x80000000
_REFUSE: Final = 0x00050000 | errno.EPERM
_MISSING: Final = 0x00050000 | errno.ENOSYS
_ALLOW: Final = 0x7FFF0000
_NUMBER_AT, _ARCH_AT, _ARGUMENTS_AT = 0, 4, 16
_X32_BIT: Final = 0x40000000

Instruction = tuple[int, int, int, int]
"""Code, jump if true, jump if false, operand."""


def filter_program(machine: str, calls: Sequence[Syscall] = CALLS) -> list[Instruction]:
    """Return the program of the filter for one processor.

    Args:
        machine: `x86_64` or `aarch64`.
        calls: what is allowed.

    Raises:
        KeyError: the table does not know it.
    """
    program: list[Instruction] = [
        (_LOAD, 0, 0, _ARCH_AT),
        (_JUMP_IF_EQUAL, 1, 0, AUDIT_ARCHES[machine]),
        (_RETURN, 0, 0, _KILL_PROCESS),
        (_LOAD, 0, 0, _NUMBER_AT),
    ]
    if machine == "x86_64":
        # The same processor has a second set of numbers, for programs with pointers of 32 bits.
        program += [(_JUMP_IF_AT_LEAST, 0, 1, _X32_BIT), (_RETURN, 0, 0, _KILL_PROCESS)]
    for call in calls:
        number = call.x86_64 if machine == "x86_64" else call.aarch64
        if number is not None:
            block = [step for check in call.checks for step in _steps(check)] + [
                (_RETURN, 0, 0, _MISSING if call.is_missing else _ALLOW)
            ]
            program += [(_JUMP_IF_EQUAL, 0, len(block), number), *block]
    return [*program, (_RETURN, 0, 0, _REFUSE)]


def _steps(check: Check) -> list[Instruction]:
    """Return steps that go on behind them if the check holds, and refuse the call if not."""
    low = _ARGUMENTS_AT + 8 * check.argument
    refuse = (_RETURN, 0, 0, _REFUSE)
    # The upper half of an argument of 32 bits is ignored by the kernel, but a pointer has one.
    upper_is_zero: list[Instruction] = [(_LOAD, 0, 0, low + 4), (_JUMP_IF_EQUAL, 1, 0, 0), refuse]
    if check.kind == "none_of":
        return [(_LOAD, 0, 0, low), (_JUMP_IF_BITS, 0, 1, check.values[0]), refuse]
    if check.kind == "not_all_of":
        bits = check.values[0]
        return [(_LOAD, 0, 0, low), (_AND, 0, 0, bits), (_JUMP_IF_EQUAL, 0, 1, bits), refuse]
    count = len(check.values)
    tests: list[Instruction] = [(_JUMP_IF_EQUAL, count - place, 0, value) for place, value in enumerate(check.values)]
    return [*([] if check.kind == "one_of_low" else upper_is_zero), (_LOAD, 0, 0, low), *tests, refuse]


def packed(program: list[Instruction]) -> bytes:
    """Return the program as an array of `struct sock_filter`."""
    return b"".join(struct.pack("=HBBI", *step) for step in program)
