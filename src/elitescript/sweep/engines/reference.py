"""What of a computer rows depend on: versions, and the last bit of sine and cosine, as one reference run shows it.

A process of its own prints it (`python -m elitescript.sweep.engines.reference`), so that a worker of a cluster need
not become a robot for it.
"""

from __future__ import annotations

import json
import subprocess
import sys
from hashlib import sha256
from typing import Final

from elitescript import __version__
from elitescript.environment.process import module_command, module_environment
from elitescript.records import NamedTuple

LIMIT_S: Final = 120.0
"""Wall time after which a computer is too slow, or stuck, *assumed*."""

PROGRAM: Final = """\
def reference():
  # Each pass depends on the one before and stretches what differs: one last bit anywhere changes every later digit.
  x = 0.3
  y = 0.7
  n = 0
  while n < 500:
    x = sin(37.0 * x + y)
    y = cos(41.0 * y - x)
    x = atan2(y + x, 0.13 + x * x) + asin(0.9 * y)
    y = pow(2.7, 0.5 * y) + log(2.7, 2 + x * x) + acos(0.9 * cos(y)) - tan(0.7 * x) + sqrt(1 + x * x)
    n = n + 1
  end
  textmsg("{!r} {!r}".format(x, y))
  movej([0.1, -1.4, -1.5, -1.7, 1.5, 0.2], a=3, v=2)
  movel(pose_trans(get_actual_tcp_pose(), [0.05, 0.02, 0.03, 0.1, 0, 0]), a=1, v=0.3)
  textmsg("{!r} {!r}".format(get_actual_tcp_pose(), get_actual_joint_positions()))
end
"""
"""Writes numbers with all their digits; about 1 s of robot time, 20 ms of computation."""


class Platform(NamedTuple):
    """What the rows of a process depend on, beside the plan.

    Attributes:
        version: of elitescript.
        python: its first two numbers, as `3.11`.
        greenlet: its version.
        digits: digest of the reference run: equal where sine, cosine and their like agree in every bit.
    """

    version: str
    python: str
    greenlet: str
    digits: str


def versions_here() -> tuple[str, str, str]:
    """Return the versions of elitescript, Python and greenlet."""
    from greenlet import __version__ as greenlet  # type: ignore[import-untyped]

    return __version__, f"{sys.version_info.major}.{sys.version_info.minor}", greenlet


def platform_here() -> Platform:
    """Return the platform of this process, by a run in it.

    Raises:
        RuntimeError: the program did not end as it must.
    """
    from elitescript.robot import VirtualRobot

    run = VirtualRobot().run(PROGRAM)
    if run.state != "finished":
        raise RuntimeError(f"the reference run ended as {run.state}: {run.alarms}")
    return Platform(*versions_here(), sha256("\n".join(run.log).encode()).hexdigest()[:16])


def platform_of_child() -> Platform:
    """Return the platform of a process that is started as those that do runs are.

    Raises:
        RuntimeError: it did not answer; the text is what it wrote.
    """
    done = subprocess.run(
        module_command("elitescript.sweep.engines.reference"),
        env=module_environment(),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=LIMIT_S,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(done.stderr.decode("utf-8", "replace").strip() or f"exit code {done.returncode}")
    return Platform(*json.loads(done.stdout))


if __name__ == "__main__":
    print(json.dumps(platform_here()))
