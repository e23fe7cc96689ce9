"""The robot of a random session: its arm, limits, surfaces, things around it, and what it remembers."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

from elitescript import PlantConfig, VirtualRobot
from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.models.model import RobotModel, load_model, parse_model
from elitescript.runtime.environment import EmptyEnvironment
from elitescript.testing.world import World
from tests.audit.fit.hidden_arms import hidden_arm
from tests.chaos.programs import MICRO_FILE
from tests.invariants.random_devices import RPC_S, random_world
from tests.invariants.test_micro_invariants import random_file
from tests.invariants.test_safety_invariants import random_limits
from tests.solids import every_tick

DEFAULT = "CS66"
ARMS = ("CS63", "CS612", "CS620")
WORLD_FILE = "world.toml"
STATE_FILE = "state.json"
NO_NETWORK = '[world]\nnetwork = "virtual"\n'


def random_options(chance: Random, kind: str) -> dict[str, Any]:
    """Return options of a session; each may be left out of it."""
    options: dict[str, Any] = {"seed": chance.randrange(1000)}
    if chance.random() < 0.3:
        options["model"] = chance.choice(ARMS)
    elif chance.random() < 0.2:
        options["own_arm"] = chance.randrange(10)
    if chance.random() < 0.3:
        options["firmware"] = chance.choice(("2.10", "2.14"))
    if chance.random() < 0.3:
        options["work_per_tick"] = chance.choice((150, 1000))
    if chance.random() < 0.2:
        options["lag_s"] = chance.choice((0.01, 0.04))
    elif chance.random() < 0.1:
        options["noise_rad"] = 1e-5
    if chance.random() < 0.1:
        options["power_on"] = False
    if chance.random() < 0.15:
        options["limits"] = chance.randrange(10**6)
    if chance.random() < (0.6 if kind == "presses" else 0.05):
        options["surface"] = [round(chance.uniform(0.3, 0.5), 3), chance.choice((1e3, 1e4, 4e4))]
    if kind != "talk" and chance.random() < 0.08:
        options["things"] = every_tick.random_world(chance)
    if chance.random() < 0.04:
        options["remembers"] = True
    if chance.random() < 0.1:
        options["confirms_popups"] = False
    return options


def model_of(options: dict[str, Any]) -> RobotModel:
    """Return the arm."""
    if "own_arm" in options:
        return parse_model("own.toml", hidden_arm(options["own_arm"]).arm_file)
    return load_model(options.get("model", DEFAULT))


def surroundings(session: dict[str, Any], folder: Path) -> Any:
    """Return what is around the robot: devices, things of a world file, a task folder, or nothing."""
    if session["kind"] == "talk":
        return random_world(Random(f"world {session['seed']}"), session["seed"])
    if "things" in session["options"]:
        path = folder / WORLD_FILE
        path.write_text(NO_NETWORK + session["options"]["things"], encoding="utf-8")
        return path
    return World() if session["kind"] == "points" else EmptyEnvironment()


def robot_of(session: dict[str, Any], folder: Path) -> tuple[VirtualRobot, World | None]:
    """Return the robot of a session, and its devices."""
    given = session["options"]
    options: dict[str, Any] = {
        name: given[name]
        for name in ("seed", "firmware", "work_per_tick", "power_on", "confirms_popups")
        if name in given
    }
    drives = {name: given[name] for name in ("lag_s", "noise_rad") if name in given}
    if drives:
        options["plant"] = PlantConfig(**drives, seed=1)
    if "limits" in given:
        options["safety"] = random_limits(Random(f"limits {given['limits']}"))
    if "surface" in given:
        height, stiffness = given["surface"]
        options["contact"] = ContactConfig((Plane((0.0, 0.0, height), (0.0, 0.0, 1.0), stiffness),))
    if session["kind"] == "talk":
        options |= {"rpc_timeout_s": RPC_S, "firmware": "2.14"}
    if session["kind"] == "points":
        chance = Random(f"file {session['seed']}")
        options["task_dir"] = {MICRO_FILE: random_file(chance, chance.random() < 0.5)[0]}
    if "remembers" in given:
        options["state_file"] = folder / STATE_FILE
    world = surroundings(session, folder)
    robot = VirtualRobot(model_of(given), world=world, **options)
    return robot, world if isinstance(world, World) else None
