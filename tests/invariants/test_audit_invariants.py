"""Random differences planted into recorded programs are found where they are, and nothing is found without one."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import pytest

from elitescript.audit import audit
from elitescript.world_file import closed_world
from tests.audit.recording_runs import record_run
from tests.invariants.cases import CASES

EXAMPLES = Path(__file__).parents[2] / "examples"

HEAD = "def main():\n"
TAIL = "end\nmain()\n"


def random_lines(draw: random.Random) -> list[str]:
    """Return the statements of a program: moves with and without blends, waits, outputs."""
    q = [0.0, -1.5, -1.5, -1.5, 1.5, 0.2]
    lines: list[str] = []
    for _ in range(draw.randrange(4, 9)):
        kind = draw.random()
        if kind < 0.6:
            joint = draw.randrange(3)
            q[joint] += draw.choice((-1, 1)) * draw.uniform(0.1, 0.4)
            q[joint] = max(min(q[joint], -0.8 if joint else 1.0), -2.0)
            r = draw.choice(("", "", f", r={draw.uniform(0.005, 0.03):.3f}"))
            lines.append(f"  movej({[round(value, 3) for value in q]}, a={draw.uniform(2, 6):.2f}, v=0.6{r})")
        elif kind < 0.8:
            lines.append(f"  sleep({draw.uniform(0.05, 0.3):.3f})")
        else:
            lines.append(f"  set_standard_digital_out({draw.randrange(4)}, {draw.random() < 0.7})")
    return lines


def planted(draw: random.Random, lines: list[str]) -> tuple[int, str, list[str]] | None:
    """Return the index of a line, the name of a difference, and the lines with it; None if there is no place for it."""
    changed = list(lines)
    name = draw.choice(("sleep", "acceleration", "speed"))
    places = [index for index, line in enumerate(lines) if line.startswith("  sleep" if name == "sleep" else "  movej")]
    if not places:
        return None
    at = draw.choice(places)
    if name == "sleep":
        changed[at] = "  sleep(0.6)"
    elif name == "acceleration":
        changed[at] = changed[at].replace("a=", "a=0.5*")
    else:
        changed[at] = changed[at].replace("v=0.6", "v=0.2")
    return at, name, changed


@pytest.mark.invariants
@pytest.mark.slow
@pytest.mark.parametrize("seed", range(CASES))
def test_random_programs(seed: int) -> None:
    draw = random.Random(seed)
    lines = random_lines(draw)
    text = HEAD + "\n".join(lines) + "\n" + TAIL
    disturbed = {"lost": 0.01, "noise_rad": 1e-4, "seed": seed, "wait_s": 0.004 * draw.randrange(5, 60)}
    recording = record_run(text, speed=draw.choice((1.0, 0.7)), **disturbed)
    found = audit(recording, text)
    assert found.agrees, f"{text}\n{found}"
    if (hidden := planted(draw, lines)) is None:
        return
    at, name, changed = hidden
    other = record_run(HEAD + "\n".join(changed) + "\n" + TAIL, **disturbed)
    divergence = audit(other, text).divergence
    if divergence is None:
        # A move that is too short to reach its speed, or a line that stands still.
        assert abs(other.t[-1] - record_run(text, **disturbed).t[-1]) < 0.05, (name, lines[at])
        return
    # A blend belongs to the lines on both sides of it.
    assert abs(divergence.line - (at + 2)) <= 1, f"{name} in line {at + 2}\n{text}\n{divergence}"


NOT_MOVING = {"parse_sensor"}
"""Examples whose program ends in the control period in which it begins."""


@pytest.mark.slow
@pytest.mark.parametrize("lossy", [False, True])
@pytest.mark.parametrize(
    "path",
    [path for path in sorted(EXAMPLES.glob("*.script")) if path.stem not in NOT_MOVING],
    ids=lambda path: path.stem,
)
def test_every_example_agrees_with_itself(path: Path, lossy: bool) -> None:
    file = path.with_suffix(".toml")
    world = str(file) if file.exists() else None
    settings: dict[str, Any] = {"wait_s": 0.06}
    if lossy:
        settings = {"wait_s": 0.132, "phase_s": 0.0013, "lost": 0.01, "noise_rad": 1e-4, "jitter_s": 0.01, "seed": 3}
    around = closed_world(world, is_trusted=True)
    recording = record_run(path, until_s=300.0, world=around, task_dir=EXAMPLES, **settings)
    found = audit(recording, path, world=world)
    assert found.agrees, str(found)
