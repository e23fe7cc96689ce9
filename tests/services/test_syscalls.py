"""The filter program, run by a small machine of our own, on both processors."""

import errno
import re
from pathlib import Path

import pytest

from elitescript.services.child.syscalls import (
    AUDIT_ARCHES,
    CALLS,
    CONNECTING,
    COPYING,
    allowed,
    filter_program,
    packed,
)

ALLOW, KILL, REFUSE = 0x7FFF0000, 0x80000000, 0x00050000 | errno.EPERM
BY_NAME = {call.name: call for call in CALLS}


def verdict(machine: str, number: int, *arguments: int, arch: int | None = None, calls=CALLS) -> int:
    """What the filter says of a call."""
    words = {0: number, 4: AUDIT_ARCHES[machine] if arch is None else arch}
    for index in range(6):
        value = arguments[index] if index < len(arguments) else 0
        words[16 + 8 * index], words[20 + 8 * index] = value & 0xFFFFFFFF, value >> 32
    program, at, register = filter_program(machine, calls), 0, 0
    while True:
        code, if_true, if_false, operand = program[at]
        at += 1
        if code == 0x20:
            register = words[operand]
        elif code == 0x54:
            register &= operand
        elif code == 0x06:
            return operand
        else:
            is_true = {0x15: register == operand, 0x35: register >= operand, 0x45: bool(register & operand)}[code]
            at += if_true if is_true else if_false


def number_of(name: str, machine: str) -> int:
    number = BY_NAME[name].x86_64 if machine == "x86_64" else BY_NAME[name].aarch64
    assert number is not None
    return number


@pytest.mark.parametrize("machine", AUDIT_ARCHES)
class TestFilter:
    def test_allows_what_is_in_the_table(self, machine):
        for call in CALLS:
            number = call.x86_64 if machine == "x86_64" else call.aarch64
            if number is not None and not call.checks:
                assert verdict(machine, number) == ALLOW

    def test_refuses_every_other_number(self, machine):
        known = {call.x86_64 if machine == "x86_64" else call.aarch64 for call in CALLS}
        assert {verdict(machine, number) for number in set(range(600)) - known} == {REFUSE}

    def test_ends_a_process_that_calls_as_another_processor(self, machine):
        assert verdict(machine, number_of("read", machine), arch=0x40000003) == KILL

    @pytest.mark.parametrize(
        ("flags", "expected"),
        [(0, ALLOW), (0o2000000, ALLOW), (1, REFUSE), (2, REFUSE), (0o100, REFUSE), (0o1000, REFUSE), (0o102, REFUSE)],
    )
    def test_opens_files_for_reading_only(self, machine, flags, expected):
        assert verdict(machine, number_of("openat", machine), 2**64 - 100, 1, flags) == expected

    @pytest.mark.parametrize(("prot", "expected"), [(1, ALLOW), (3, ALLOW), (5, ALLOW), (6, REFUSE), (7, REFUSE)])
    def test_maps_no_memory_to_write_and_run(self, machine, prot, expected):
        assert verdict(machine, number_of("mmap", machine), 0, 4096, prot) == expected

    @pytest.mark.parametrize(("prot", "expected"), [(1, ALLOW), (3, ALLOW), (4, REFUSE), (5, REFUSE)])
    def test_lets_no_memory_become_code(self, machine, prot, expected):
        assert verdict(machine, number_of("mprotect", machine), 0, 4096, prot) == expected

    @pytest.mark.parametrize(
        ("pid", "limit", "expected"),
        [(0, 0, ALLOW), (1, 0, REFUSE), (0, 0x7FFF00001000, REFUSE), (0, 0x100000000, REFUSE), (0, 4096, REFUSE)],
    )
    def test_reads_own_limits_and_sets_none(self, machine, pid, limit, expected):
        assert verdict(machine, number_of("prlimit64", machine), pid, 7, limit) == expected

    @pytest.mark.parametrize(("command", "expected"), [(1, ALLOW), (3, ALLOW), (0, REFUSE), (4, REFUSE), (8, REFUSE)])
    def test_changes_no_descriptor(self, machine, command, expected):
        assert verdict(machine, number_of("fcntl", machine), 0, command) == expected

    def test_fits_into_what_a_kernel_takes(self, machine):
        program = filter_program(machine)
        assert len(program) <= 4096
        assert len(packed(program)) == 8 * len(program)
        assert all(0 <= jump <= 255 for step in program for jump in step[1:3])


@pytest.mark.parametrize(("machine", "clone", "pair"), [("x86_64", 56, 53), ("aarch64", 220, 199)])
def test_copies_share_everything_and_talk_to_nobody_else(machine, clone, pair):
    calls = (*CALLS, *COPYING)
    assert verdict(machine, clone, 0x1200011, calls=calls) == ALLOW
    # A user namespace, a network namespace.
    assert verdict(machine, clone, 0x10000011, calls=calls) == REFUSE
    assert verdict(machine, clone, 0x40000011, calls=calls) == REFUSE
    assert verdict(machine, pair, 1, 1, calls=calls) == ALLOW
    assert verdict(machine, pair, 2, 1, calls=calls) == REFUSE
    # Datagrams may have another address each.
    assert verdict(machine, pair, 1, 2, calls=calls) == REFUSE
    assert verdict(machine, clone, 0x1200011) == REFUSE


@pytest.mark.parametrize(
    ("machine", "socket", "listen", "bind", "clone", "ioctl"),
    [("x86_64", 41, 50, 49, 56, 16), ("aarch64", 198, 201, 200, 220, 29)],
)
def test_connections_are_begun_and_nothing_else(machine, socket, listen, bind, clone, ioctl):
    calls = allowed(may_connect=True)
    for family, kind, expected in (
        *((2, 1, ALLOW), (10, 1, ALLOW), (2, 2, ALLOW), (2, 0x80801, ALLOW), (0xFFFFFFFF00000002, 1, ALLOW)),
        *((1, 1, REFUSE), (16, 3, REFUSE), (17, 3, REFUSE), (2, 3, REFUSE), (2, 0x100000001 + 2, REFUSE)),
    ):
        assert verdict(machine, socket, family, kind, calls=calls) == expected, (family, kind)
    assert verdict(machine, listen, 3, 1, calls=calls) == REFUSE
    assert verdict(machine, bind, 3, 1, calls=calls) == REFUSE
    assert verdict(machine, clone, 0x3D0F00, calls=calls) == ALLOW, "a thread"
    assert verdict(machine, clone, 0x1200011, calls=calls) == REFUSE, "a process"
    assert verdict(machine, 435, 4096, 88, calls=calls) == 0x00050000 | errno.ENOSYS, "clone3, then clone"
    assert verdict(machine, ioctl, 3, 0x541B, calls=calls) == ALLOW
    assert verdict(machine, ioctl, 3, 0x5412, calls=calls) == REFUSE, "typing into a terminal"
    assert verdict(machine, socket, 2, 1) == REFUSE


def test_the_second_set_of_numbers_is_closed():
    assert verdict("x86_64", 0x40000000) == KILL


@pytest.mark.parametrize(
    ("path", "column"),
    [("/usr/include/x86_64-linux-gnu/asm/unistd_64.h", "x86_64"), ("/usr/include/asm-generic/unistd.h", "aarch64")],
)
def test_numbers_are_those_of_the_headers(path, column):
    if not Path(path).exists():
        pytest.skip(f"{path} is not installed")
    text = Path(path).read_text()
    defined = {name: int(number) for name, number in re.findall(r"#define __NR(?:3264)?_(\w+) (\d+)", text)}
    defined.setdefault("newfstatat", defined.get("fstatat", -1))
    for call in (*CALLS, *COPYING, *CONNECTING):
        number = getattr(call, column)
        assert number is None or number == defined[call.name], call.name
