"""The six models, their sources, and what the loader refuses."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace
from math import hypot, pi, radians
from pathlib import Path

import pytest

from elitescript.errors import UsageError
from elitescript.kinematics.jacobian import singularity
from elitescript.messages.plant import PlantConfig
from elitescript.models.datafile import EVIDENCE, MODEL_FOLDER
from elitescript.models.model import (
    JOINT_NAMES,
    LINK_NAMES,
    RobotModel,
    load_model,
    load_model_file,
    model_names,
)

NAMES = ("CS63", "CS66", "CS612", "CS616", "CS620", "CS625")
MODELS = {name: load_model(name) for name in model_names()}
FULL = (MODEL_FOLDER / "cs66.toml").read_text(encoding="utf-8")


def write(folder: Path, text: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(params=MODELS)
def model(request: pytest.FixtureRequest) -> RobotModel:
    return MODELS[request.param]


def test_the_six_models_are_there_small_arms_first() -> None:
    assert model_names() == NAMES


def test_a_model_has_the_name_it_is_found_by(model: RobotModel) -> None:
    assert load_model(model.name) == load_model(model.name.lower()) == model


def test_type_ids_are_those_of_the_simulator() -> None:
    assert [MODELS[name].type_id for name in NAMES] == [6203, 6206, 6212, 6216, 6220, 6225]


def test_reach_is_upper_arm_and_forearm_and_wrist(model: RobotModel) -> None:
    # Catalogues print whole centimetres or millimetres.
    assert model.reach_m == pytest.approx(-model.arm.a2 - model.arm.a3 + model.arm.d5, abs=1e-6)


def test_joints_are_named_and_their_limits_ordered(model: RobotModel) -> None:
    assert tuple(joint.name for joint in model.joints) == JOINT_NAMES
    for joint in model.joints:
        assert joint.q_min < 0 < joint.q_max
        assert radians(90) <= joint.qd_max <= radians(360)
        assert model.planning_joint_acceleration < joint.qdd_max <= model.max_joint_acceleration
        assert joint.effort_max > 0
    assert model.joint_ranges == ((-2 * pi, 2 * pi),) * 6


def test_stronger_joints_sit_nearer_the_base(model: RobotModel) -> None:
    efforts = [joint.effort_max for joint in model.joints]
    assert efforts == sorted(efforts, reverse=True)


def test_quoted_joint_speeds_of_the_cs66() -> None:
    speeds = [joint.qd_max for joint in MODELS["CS66"].joints]
    assert speeds == [radians(deg) for deg in (150, 150, 180, 230, 230, 230)]


def test_defaults_fit_into_the_limits(model: RobotModel) -> None:
    assert model.default_joint_speed < min(joint.qd_max for joint in model.joints)
    assert model.default_joint_acceleration < model.planning_joint_acceleration
    assert model.default_tool_speed < model.max_tool_speed
    assert model.default_tool_acceleration < model.max_tool_acceleration


def test_safety_limits_of_the_reduced_mode_are_the_tighter_ones(model: RobotModel) -> None:
    normal, reduced = model.safety.normal, model.safety.reduced
    for name in ("tool_speed", "elbow_speed", "tool_force", "power", "momentum", "stop_time_s", "stop_distance"):
        assert 0 < getattr(reduced, name) < getattr(normal, name)
    assert model.default_tool_speed < reduced.tool_speed


def test_home_is_inside_the_ranges_and_far_from_every_singularity(model: RobotModel) -> None:
    assert model.home == pytest.approx((0, -pi / 2, -pi / 2, -pi / 2, pi / 2, 0))
    assert min(singularity(model.arm, model.home)) > 0.2
    # Tool down.
    assert model.arm.forward(model.home)[8] == pytest.approx(-1.0)


def test_moving_mass_adds_up() -> None:
    masses = [sum(link.mass for link in MODELS[name].links) for name in NAMES]
    assert masses == pytest.approx([14.099, 18.569, 29.820, 29.656, 59.422, 58.468])


def test_inertia_is_one_that_a_body_can_have(model: RobotModel) -> None:
    assert tuple(link.name for link in model.links) == LINK_NAMES
    for link in model.links:
        xx, yy, zz, xy, xz, yz = link.inertia
        minor = xx * yy - xy * xy
        determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
        assert xx > 0
        assert minor > 0
        assert determinant > 0
        assert xx + yy > zz
        assert yy + zz > xx
        assert zz + xx > yy
        assert hypot(*link.com) < model.reach_m / 2


def test_arms_differ_only_where_their_files_do() -> None:
    one, other = MODELS["CS612"], MODELS["CS616"]
    assert one.arm != other.arm
    assert one.safety == other.safety
    assert one.home == other.home


def test_models_are_frozen(model: RobotModel) -> None:
    with pytest.raises(FrozenInstanceError):
        model.payload_max_kg = 99.0  # type: ignore[misc]


def test_every_number_has_a_source_that_says_how_it_knows(model: RobotModel) -> None:
    assert len(model.sources.all_keys()) > 50
    for key in model.sources.all_keys():
        source = model.source(key)
        assert source.evidence in EVIDENCE
        assert source.about
        assert source.date
        assert source.trust


def test_sources_are_asked_for_by_the_path_of_the_number() -> None:
    cs66 = MODELS["CS66"]
    assert cs66.source("joints.elbow.qd_max")[:2] == ("datasheet-quoted", "documented")
    assert "180" in cs66.source("joints.elbow.qd_max").why
    assert cs66.source("arm.d1").source == "ros-kinematics"
    assert cs66.source("links.forearm.mass").source == "ros-masses"
    assert cs66.source("home").evidence == "assumed"
    assert cs66.source("safety.normal.power").evidence == "assumed"
    assert cs66.source("max_joint_acceleration") == cs66.source("joints.wrist3.qdd_max")
    assert MODELS["CS63"].source("joints.elbow.qd_max").source == "ros-limits"


def test_asking_for_the_source_of_nothing_names_the_nearest_number() -> None:
    with pytest.raises(UsageError, match=r"CS66 has no number 'joints.qdmax'; did you mean 'joints.qd_max'\?"):
        MODELS["CS66"].source("joints.elbow.qdmax")


@pytest.mark.parametrize(("name", "nearest"), [("CS6 6", "CS66"), ("CS67", "CS6"), ("cs621", "CS62"), ("UR5", None)])
def test_unknown_model_names_the_nearest_and_all(name: str, nearest: str | None) -> None:
    with pytest.raises(UsageError, match="there is no robot model") as caught:
        load_model(name)
    assert "CS63, CS66, CS612, CS616, CS620, CS625" in str(caught.value)
    assert ("did you mean" in str(caught.value)) == (nearest is not None)
    assert nearest is None or f"did you mean '{nearest}" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "base"),
    [
        ("CS68", "CS66"),
        ("cs616-9", "CS616"),
        ("CS616_9", "CS616"),
        ("CS618", "CS616"),
        ("CS630", "CS625"),
        ("CS66A", "CS66"),
        ("CS610A", "CS612"),
        ("CS612AZ", "CS612"),
        ("CS56H", "CS66"),
        ("cs520h", "CS620"),
        ("CS525H", "CS625"),
        ("CS530H", "CS625"),
    ],
)
def test_an_arm_without_public_numbers_is_said_to_exist(name: str, base: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError) as caught:
        load_model(name)
    words = str(caught.value)
    assert words.startswith(
        f"the arm {name.upper().replace('_', '-')} exists, but its lengths and limits are not public"
    )
    assert f'base = "{base}"' in words
    assert "did you mean" not in words
    # What it proposes is an arm file.
    (tmp_path / "my_arm.toml").write_text(f'base = "{base}"\n[arm]\nd6 = 0.095\n')
    assert load_model(tmp_path / "my_arm.toml").arm.modified_dh[1][5] == 0.095


@pytest.mark.parametrize("name", ["", "common", "../cs66", "/etc/passwd", "cs66.tom"])
def test_a_name_is_not_a_path(name: str) -> None:
    with pytest.raises(UsageError, match="there is no robot model"):
        load_model(name)


def test_a_model_is_one_file(tmp_path: Path) -> None:
    text = (MODEL_FOLDER / "cs66.toml").read_text(encoding="utf-8").replace('"CS66"', '"CS68"')
    text = text.replace("value = 6206", "value = 6208")
    found = load_model_file(write(tmp_path, text))
    assert (found.name, found.type_id) == ("CS68", 6208)
    assert found.arm == MODELS["CS66"].arm


def full(changed: str) -> str:
    """Return the complete file of the CS66 with one of its entries replaced, or one more."""
    table, _, line = changed.rpartition("]\n")
    header = f"{table}]\n" if table else ""
    key = line.partition(" =")[0]
    text = "\n".join(row for row in FULL.split("\n") if row.partition(" =")[0] != key)
    if not header:
        return f"{line}{text}"
    return text.replace(header, f"{header}{line}") if header in text else f"{text}\n{header}{line}"


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("name = ", r"mine\.toml:1: the arm file is not TOML"),
        ("", r"mine\.toml: name: missing"),
        ("name = 3\n", r"mine\.toml: name: needs a text, has 3"),
        ('name = "Mine"\n', r"mine\.toml: joints\.qd_max: missing"),
        ('name = "Mine"\nbased_on = { value = 1, source = "sdk" }\n', r"mine\.toml: based_on: unknown key"),
        ('like = "CS66"\n[arm]\nd6 = 0.1\n', r"^mine\.toml: like: unknown key; did you mean 'base'\?$"),
        ('bas = "CS67"\n', r"^mine\.toml: bas: unknown key; did you mean 'base'\?$"),
        ("payload_max = 5\n", r"^mine\.toml: payload_max: unknown key; did you mean 'payload_max_kg'\?$"),
        ('name = "Mine"\n[plant]\nlag_s = 0.1\n', r"^mine\.toml: plant: unknown key"),
        (full("payload_max_kg = 5\n"), r"mine\.toml: payload_max_kg: needs the form \{ value = "),
        (full("payload_max_kg = { value = 5 }\n"), r"mine\.toml: payload_max_kg: no source"),
        (
            full('payload_max_kg = { value = 5, source = "choosen" }\n'),
            r"mine\.toml: payload_max_kg: unknown source 'choosen'; did you mean 'chosen'\?",
        ),
        (full('payload_max_kg = { value = "5", source = "sdk" }\n'), r"payload_max_kg: needs a number, has '5'"),
        (full('payload_max_kg = { value = true, source = "sdk" }\n'), "payload_max_kg: needs a number, has True"),
        (full('payload_max_kg = { value = -5, source = "sdk" }\n'), "payload_max_kg: needs a number above 0"),
        (full('payload_max_kg = { value = inf, source = "sdk" }\n'), "payload_max_kg: needs a finite number"),
        (full('payload_max_kg = { source = "sdk" }\n'), "payload_max_kg: needs `value` or `deg`"),
        (full('payload_max_kg = { value = 5, deg = 5, source = "sdk" }\n'), "payload_max_kg: needs `value` or"),
        (full('payload_max_kg = { value = 5, unit = "kg", source = "sdk" }\n'), "payload_max_kg: needs `value`"),
        (
            full('payload_max = { value = 5, source = "sdk" }\n'),
            r"mine\.toml: payload_max: unknown key; did you mean 'payload_max_kg'\?",
        ),
        (full('home = { value = 5, source = "sdk" }\n'), r"mine\.toml: home: needs 6 numbers in brackets, has 5"),
        (full('home = { value = [0, 0], source = "sdk" }\n'), r"mine\.toml: home: needs 6 numbers, has 2"),
        (
            full('home = { deg = [0, 0, 0, 0, 0, 400], source = "sdk" }\n'),
            r"mine\.toml: home: 6\.98.* rad of wrist3 is outside its range",
        ),
        (
            full('[joints]\nq_min = { deg = [360, 0, 0, 0, 0, 0], source = "sdk" }\n'),
            r"mine\.toml: joints\.q_min: 6\.28.* rad of base is not below its joints\.q_max",
        ),
        (full('[arm]\na2 = { value = 0.4, source = "sdk" }\n'), r"mine\.toml: arm: a2 of the arm is 0\.4 m"),
        (
            full('[calibration]\nd = { value = [0, 0, 0, 0, 0, 0], source = "sdk" }\n'),
            r"mine\.toml: arm: d\[0\] of the calibration is 0 m, nominal is 0\.1625 m",
        ),
        (full('[sources.mine]\nabout = "x"\n'), r"mine\.toml: sources\.mine\.evidence: missing"),
        (
            full('[sources.mine]\nabout = "x"\ndate = "x"\ntrust = "x"\nevidence = "guessed"\n'),
            r"mine\.toml: sources\.mine\.evidence: has 'guessed', needs one of documented, observed, assumed",
        ),
        (full("sources = 3\n"), r"mine\.toml: sources: needs tables"),
        (full("[sources]\nmine = 3\n"), r"mine\.toml: sources\.mine: needs a table"),
        (
            full('[sources.mine]\nabout = 3\ndate = "x"\ntrust = "x"\nevidence = "observed"\n'),
            r"mine\.toml: sources\.mine\.about: needs a text, has 3",
        ),
    ],
)
def test_a_wrong_file_is_refused_with_file_and_key(tmp_path: Path, text: str, complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint):
        load_model_file(write(tmp_path, text))


def test_a_file_that_cannot_be_read_is_refused_by_its_path(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"cannot read .*absent\.toml: No such file"):
        load_model_file(tmp_path / "absent.toml")


def test_a_file_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(UsageError, match=r"mine\.toml:1: the arm file is not UTF-8: it is UTF-16"):
        load_model_file(path)


def test_a_huge_file_is_refused_unread(tmp_path: Path) -> None:
    path = write(tmp_path, "#" * 1_000_001)
    with pytest.raises(UsageError, match="it has 1000001 bytes; at most 1000000 bytes are read"):
        load_model_file(path)


class TestOwnArm:
    def test_it_is_its_base_but_for_what_it_says(self, tmp_path: Path) -> None:
        found = load_model_file(write(tmp_path, 'base = "cs66"\n[arm]\nd6 = 0.095\n'))
        cs66 = MODELS["CS66"]
        assert found.arm == replace(cs66.arm, d6=0.095)
        assert replace(found, arm=cs66.arm) == cs66
        assert found.source("arm.d6")[:2] == ("own-arm", "assumed")
        assert found.source("arm.d5") == cs66.source("arm.d5")

    def test_it_says_once_where_its_numbers_come_from(self, tmp_path: Path) -> None:
        text = 'base = "CS66"\nabout = "name plate"\nevidence = "observed"\ndate = "2025"\npayload_max_kg = 5\n'
        found = load_model_file(write(tmp_path, text))
        assert found.payload_max_kg == 5.0
        assert found.source("payload_max_kg") == (
            "own-arm",
            "observed",
            "",
            "name plate",
            "2025",
            "as far as mine.toml can be trusted",
        )

    def test_angles_may_stand_in_degrees(self, tmp_path: Path) -> None:
        text = (
            'base = "CS66"\nname = "Mine"\ndefault_joint_speed_deg = 90\nhome_deg = [90, -90, -90, -90, 90, 0]\n'
            "[joints]\nq_max = [3, 6, 3, 6, 6, 6]\nqd_max_deg = [100, 100, 100, 200, 200, 200]\n"
        )
        found = load_model_file(write(tmp_path, text))
        assert found.name == "Mine"
        assert found.default_joint_speed == pytest.approx(pi / 2)
        assert found.home[:2] == pytest.approx((pi / 2, -pi / 2))
        assert [joint.q_max for joint in found.joints] == [3, 6, 3, 6, 6, 6]
        assert found.joints[0].qd_max == pytest.approx(radians(100))
        assert found.joints[0].q_min == MODELS["CS66"].joints[0].q_min

    def test_its_reach_follows_its_lengths_unless_it_is_given(self, tmp_path: Path) -> None:
        longer = 'base = "CS66"\n[arm]\na2 = -0.527\n'
        assert load_model_file(write(tmp_path, longer)).reach_m == pytest.approx(1.014)
        given = longer.replace("[arm]", "reach_m = 1.1\n[arm]")
        assert load_model_file(write(tmp_path, given)).reach_m == 1.1

    def test_it_may_hold_the_calibration_of_one_robot(self, tmp_path: Path) -> None:
        a, d, alpha = MODELS["CS66"].arm.modified_dh
        measured = [*d[:3], d[3] + 2e-4, *d[4:]]
        found = load_model_file(write(tmp_path, f'base = "CS66"\n[calibration]\nd = {measured}\n'))
        assert found.arm.modified_dh == (a, tuple(measured), alpha)
        assert MODELS["CS66"].calibrated(d=measured).arm == found.arm

    def test_it_may_say_how_its_joints_follow(self, tmp_path: Path) -> None:
        found = load_model_file(write(tmp_path, 'base = "CS66"\n[plant]\nlag_s = 0.02\n'))
        assert found.plant == PlantConfig(lag_s=0.02)
        assert MODELS["CS66"].plant is None

    def test_a_path_is_told_from_a_name_by_its_ending(self, tmp_path: Path) -> None:
        path = write(tmp_path, 'base = "CS66"\n')
        assert load_model(str(path)) == load_model(path) == MODELS["CS66"]
        with pytest.raises(UsageError, match=r"cannot read .*absent\.toml"):
            load_model(str(tmp_path / "absent.toml"))

    @pytest.mark.parametrize(
        ("text", "complaint"),
        [
            ("base = 3\n", r"mine\.toml: base: needs a text, has 3"),
            ('base = "CS67"\n', r"mine\.toml: base: there is no robot model 'CS67'; did you mean 'CS6"),
            ('base = "CS66"\n[arm]\nd6 = 95\n', r"mine\.toml: arm\.d6: 95 m is longer than .*; 95 mm are 0\.095 m"),
            ('base = "CS66"\n[arm]\na2 = -427\n', r"arm\.a2: -427 m is longer than .*; -427 mm are -0\.427 m"),
            (
                'base = "CS66"\n[joints]\nq_max = [175, 360, 160, 360, 360, 360]\n',
                r"mine\.toml: joints\.q_max: 175 rad of base is more than .*; joints\.q_max_deg takes degrees",
            ),
            (
                'base = "CS66"\n[joints]\nqd_max = [180, 180, 180, 180, 180, 180]\n',
                r"joints\.qd_max: 180 rad/s of base is more than .*; joints\.qd_max_deg takes degrees",
            ),
            ('base = "../cs66"\n', "there is no robot model"),
            ('base = "CS66"\nname = 3\n', r"mine\.toml: name: needs a text, has 3"),
            ('base = "CS66"\nevidence = "guessed"\n', r"mine\.toml: evidence: has 'guessed', needs one of documented"),
            ('base = "CS66"\n[arms]\nd6 = 0.1\n', r"mine\.toml: arms\.d6: unknown key; did you mean 'arm\.d6'\?"),
            ('base = "CS66"\n[arm]\nd7 = 0.1\n', r"mine\.toml: arm\.d7: unknown key; did you mean 'arm\.d"),
            ('base = "CS66"\n[arm]\nd6_deg = 5\n', r"mine\.toml: arm\.d6_deg: unknown key"),
            ('base = "CS66"\nhom_deg = [0, 0]\n', r"mine\.toml: hom_deg: unknown key; did you mean 'home_deg'\?"),
            ('base = "CS66"\nbased_on = "CS66"\n', r"mine\.toml: based_on: unknown key"),
            ('base = "CS66"\nabot = "mine"\n', r"^mine\.toml: abot: unknown key; did you mean 'about'\?$"),
            ('base = "CS66"\n[arm]\nd6 = "0.1"\n', r"mine\.toml: arm\.d6: needs a number, has '0\.1'"),
            ('base = "CS66"\n[arm]\nd6 = [0.1]\n', r"mine\.toml: arm\.d6: needs a number, has \[0\.1\]"),
            ('base = "CS66"\n[arm]\nd6 = nan\n', r"mine\.toml: arm\.d6: needs a finite number, has nan"),
            ('base = "CS66"\n[arm]\na2 = 0.4\n', r"mine\.toml: arm: a2 of the arm is 0\.4 m; it has to be negative"),
            (
                'base = "CS66"\n[arm]\nd6 = { value = 0.1, source = "sdk" }\n',
                r"mine\.toml: arm\.d6: needs a plain number or a row of numbers",
            ),
            ('base = "CS66"\narm = 3\n', r"mine\.toml: arm: unknown key"),
            (
                'base = "CS66"\nhome = [0, 0, 0, 0, 0, 0]\nhome_deg = [0, 0, 0, 0, 0, 0]\n',
                r"mine\.toml: home_deg: given twice, in rad and in degrees",
            ),
            ('base = "CS66"\nhome_deg = [0, 0, 0, 0, 0, 400]\n', r"home: 6\.98.* rad of wrist3 is outside its range"),
            ('base = "CS66"\n[joints]\nq_max = [3, 3]\n', r"mine\.toml: joints\.q_max: needs 6 numbers, has 2"),
            ('base = "CS66"\nplant = 3\n', r"mine\.toml: plant: needs a table \[plant\], has 3"),
            ('base = "CS66"\n[plant]\nlag = 1\n', r"mine\.toml: plant\.lag: unknown key"),
            (
                'base = "CS66"\n[plant]\nlag_s = 9\n',
                r"mine\.toml: plant: lag_s of the plant must be in \[0, 1\] s, got 9",
            ),
            ('base = "CS66"\nx = ' + "[" * 20_000 + "\n", r"mine\.toml:2: it is nested too deeply"),
        ],
    )
    def test_mistakes_are_refused_with_file_and_key(self, tmp_path: Path, text: str, complaint: str) -> None:
        with pytest.raises(UsageError, match=complaint):
            load_model_file(write(tmp_path, text))
