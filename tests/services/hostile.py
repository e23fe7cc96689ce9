"""What a hostile program tries once it is out of the language: unrestricted Python in the jailed process.

Run as a program by `test_jail.py`: locks itself in, tries every action, prints what became of each as JSON.
"""

# ruff: noqa: PTH101, PTH102, PTH104, PTH108, PTH208, PTH211

import ctypes
import json
import mmap
import os
import signal
import socket
import struct
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

ACTIONS: dict[str, Callable[[], Any]] = {}
HOME_FILE = Path(__file__)
LIBC = ctypes.CDLL(None, use_errno=True)
NUMBERS = {"x86_64": 0, "aarch64": 1}.get(os.uname().machine, 0)


def action(function: Callable[[], Any]) -> Callable[[], Any]:
    ACTIONS[function.__name__] = function
    return function


def call(x86_64: int, aarch64: int, *arguments: Any) -> int:
    """A system call by its number; raises what it refuses with."""
    result = LIBC.syscall(ctypes.c_long((x86_64, aarch64)[NUMBERS]), *arguments)
    if result < 0:
        raise OSError(ctypes.get_errno(), "refused")
    return int(result)


@action
def os_system():
    status = os.system("true")
    if status != 0:
        raise OSError(status, "refused")


@action
def run_a_program():
    subprocess.run(["/bin/true"], check=True)


@action
def fork():
    if os.fork() == 0:
        os._exit(0)


@action
def vfork_by_number():
    child = call(58, 220, 17, 0, 0, 0, 0)
    if child == 0:
        os._exit(0)


@action
def replace_the_process():
    os.execv("/bin/true", ["true"])


@action
def spawn():
    os.posix_spawn("/bin/true", ["true"], {})


@action
def start_a_thread():
    threading.Thread(target=int).start()


@action
def read_passwords():
    Path("/etc/passwd").read_text()


@action
def read_the_parents_environment():
    Path(f"/proc/{os.getppid()}/environ").read_bytes()


@action
def read_the_parents_memory_map():
    Path(f"/proc/{os.getppid()}/maps").read_bytes()


@action
def read_own_memory_file():
    Path("/proc/self/mem").open("rb").close()


@action
def list_the_root_folder():
    os.listdir("/root")


@action
def list_the_file_system():
    os.listdir("/")


@action
def read_a_test_file():
    HOME_FILE.read_text()


@action
def write_a_temporary_file():
    Path("/tmp/elitescript-escaped").write_text("x")


@action
def write_into_the_package():
    Path(os.__file__).open("a").close()


@action
def make_a_folder():
    os.mkdir("/tmp/elitescript-escaped-folder")


@action
def delete_a_file():
    os.unlink(HOME_FILE.with_name("nothing.txt.that.may.be.deleted"))


@action
def rename_a_file():
    os.rename(HOME_FILE, HOME_FILE)


@action
def make_a_link():
    os.symlink("/etc/passwd", "/tmp/elitescript-escaped-link")


@action
def change_the_mode_of_a_file():
    os.chmod(HOME_FILE, 0o644)


@action
def change_the_folder():
    os.chdir("/")


@action
def make_a_file_in_memory():
    os.memfd_create("x")


@action
def tcp_socket():
    socket.socket(socket.AF_INET, socket.SOCK_STREAM)


@action
def udp_socket():
    socket.socket(socket.AF_INET, socket.SOCK_DGRAM)


@action
def unix_socket():
    socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)


@action
def socket_pair():
    socket.socketpair()


@action
def listen_for_others():
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as connection:
        connection.listen()


@action
def take_a_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as connection:
        connection.bind(("127.0.0.1", 0))


@action
def raw_socket():
    socket.socket(socket.AF_INET, socket.SOCK_RAW, socket.IPPROTO_ICMP)


@action
def netlink_socket():
    socket.socket(socket.AF_NETLINK, socket.SOCK_RAW)


@action
def raw_packet_socket():
    socket.socket(socket.AF_PACKET, socket.SOCK_RAW)


@action
def signal_the_parent():
    os.kill(os.getppid(), 0)


@action
def kill_everything():
    os.kill(-1, 0)


@action
def signal_by_file_descriptor():
    call(424, 424, call(434, 434, os.getppid(), 0), 0, None, 0)


@action
def have_the_kernel_signal_the_parent():
    import fcntl

    fcntl.fcntl(0, 8, os.getppid())


@action
def trace_the_parent():
    call(101, 117, 16, os.getppid(), 0, 0)


@action
def read_the_parents_memory():
    space = ctypes.create_string_buffer(16)
    local = struct.pack("QQ", ctypes.addressof(space), 16)
    call(310, 270, os.getppid(), local, ctypes.c_ulong(1), local, ctypes.c_ulong(1), ctypes.c_ulong(0))


@action
def steal_a_descriptor_of_the_parent():
    call(438, 438, call(434, 434, os.getppid(), 0), 0, 0)


@action
def mount():
    call(165, 40, b"none", b"/mnt", b"tmpfs", ctypes.c_ulong(0), None)


@action
def new_name_spaces():
    call(272, 97, 0x10000000)


@action
def change_the_root():
    os.chroot("/")


@action
def become_somebody_else():
    os.setuid(12345)


@action
def io_uring():
    call(425, 425, 8, ctypes.create_string_buffer(120))


@action
def load_a_kernel_program():
    call(321, 280, 0, ctypes.create_string_buffer(120), 120)


@action
def performance_counters():
    call(298, 241, ctypes.create_string_buffer(128), 0, -1, -1, ctypes.c_ulong(0))


@action
def raise_the_limit_of_memory():
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))


@action
def raise_the_limits_of_the_parent():
    import resource

    resource.prlimit(os.getppid(), resource.RLIMIT_NOFILE, (1, 1))


@action
def allow_itself_to_be_traced():
    if LIBC.prctl(4, 1, 0, 0, 0) < 0:
        raise OSError(ctypes.get_errno(), "refused")


@action
def four_gigabytes():
    bytearray(4 << 30)


@action
def memory_to_write_and_run():
    mmap.mmap(-1, 4096, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)


@action
def many_descriptors():
    held = []
    try:
        while len(held) < 100:
            held.append(os.open("/dev/null", os.O_RDONLY))
    finally:
        for descriptor in held:
            os.close(descriptor)


@action
def type_into_the_terminal():
    import fcntl

    fcntl.ioctl(0, 0x5412, b"x")


@action
def set_the_clock():
    import time

    time.clock_settime(time.CLOCK_REALTIME, time.time())


@action
def priority():
    os.nice(-5)


@action
def shared_memory():
    call(29, 194, 0, ctypes.c_size_t(4096), 0o1600)


@action
def session_keys():
    call(250, 219, 0, -3, 0, 0, 0)


HARMLESS_WHEN_FREE = (
    "os_system",
    "run_a_program",
    "start_a_thread",
    "read_passwords",
    "read_a_test_file",
    "list_the_file_system",
    "tcp_socket",
    "unix_socket",
    "socket_pair",
    "signal_the_parent",
    "make_a_file_in_memory",
    "many_descriptors",
    "memory_to_write_and_run",
)
"""Actions that work in any process that is free, and leave nothing behind: the control."""


def tried(name: str) -> str:
    """Why it was refused; empty if it was not."""
    try:
        ACTIONS[name]()
    except FileNotFoundError:
        return ""
    except (OSError, MemoryError, RuntimeError, ValueError, subprocess.SubprocessError) as error:
        return f"{type(error).__name__}: {error}"
    return ""


def main() -> None:
    signal.signal(signal.SIGSYS, signal.SIG_DFL)
    names, layers = list(ACTIONS), []
    if sys.argv[1] == "free":
        names = list(HARMLESS_WHEN_FREE)
    else:
        from elitescript.services.child.jail import enter_jail

        how = sys.argv[1]
        layers = [list(layer) for layer in enter_jail(may_copy=how == "copies", may_connect=how == "connections")]
    results = {name: tried(name) for name in names}
    from decimal import Decimal  # a module of the standard library can still be loaded

    print(json.dumps({"layers": layers, "results": results, "sum": str(Decimal(1) + 1)}), flush=True)


if __name__ == "__main__":
    main()
