"""What was found as the file of an own arm."""

import pytest

from elitescript.audit.fit.arm_file import arm_text, rounded
from elitescript.audit.fit.parameters import AT_LEAST, Parameter, determined, not_determined
from elitescript.audit.fit.words import table
from elitescript.models.model import load_model, parse_model

CS66 = load_model("CS66")
QD_MAX = [joint.qd_max for joint in CS66.joints]
OWN = {
    "base": "CS66",
    "name": "cell 3",
    "arm": {"d5": 0.0971},
    "joints": {"qd_max_deg": [100, 100, 100, 100, 100, 100], "q_min_deg": [-175, -360, -160, -360, -360, -360]},
    "plant": {"coulomb_friction": 0.05},
}


def test_what_is_determined_is_written_and_nothing_else():
    parameters = [
        determined("d6", "m", 0.092, 0.09500002, 5e-6, ""),
        not_determined("d1", "m", 0.1625, ""),
        Parameter("qd_max.2", "rad/s", 2.6, 2.5, None, AT_LEAST, ""),
        determined("plant.lag_s", "s", 0.0, 0.01234567, 1.2e-5, ""),
        determined("payload_kg", "kg", None, 2.0, 1e-9, ""),
    ]
    text = arm_text({"base": "CS66"}, parameters, QD_MAX, about="a test")
    assert text == (
        'base = "CS66"\nabout = "a test"\nevidence = "observed"\n\n[arm]\nd6 = 0.095\n\n[plant]\nlag_s = 0.012346\n'
    )
    model = parse_model("my_arm.toml", text)
    assert model.joints == CS66.joints
    assert model.arm.d6 == 0.095


def test_the_file_of_an_own_arm_keeps_its_other_entries():
    parameters = [
        determined("d6", "m", 0.092, 0.095, 1e-6, ""),
        determined("qd_max.1", "rad/s", 1.745, 1.5, 1e-4, ""),
        determined("plant.lag_s", "s", 0.0, 0.01, 1e-4, ""),
    ]
    before = parse_model("own.toml", 'base = "CS66"\n[joints]\nqd_max_deg = [100, 100, 100, 100, 100, 100]\n')
    limits = [joint.qd_max for joint in before.joints]
    model = parse_model("my_arm.toml", arm_text(OWN, parameters, limits, about="a test"))
    assert model.name == "cell 3"
    assert (model.arm.d5, model.arm.d6) == (0.0971, 0.095)
    assert [joint.qd_max for joint in model.joints] == pytest.approx([1.5, *limits[1:]])
    assert model.joints[0].q_min == pytest.approx(-3.0543, abs=1e-4)
    assert (model.plant.lag_s, model.plant.coulomb_friction) == (0.01, 0.05)
    assert OWN["arm"] == {"d5": 0.0971}


@pytest.mark.parametrize(
    ("found", "half", "written"),
    [(0.0950000237, 9e-10, 0.09500002370), (0.095004, 1.2e-5, 0.095004), (2.6173, 0.2, 2.62), (3.0, 0.0, 3.0)],
)
def test_numbers_have_the_digits_that_the_interval_gives_them(found, half, written):
    assert rounded(determined("d6", "m", None, found, half, "")) == written


def test_the_table_by_hand():
    rows = [
        determined("d6", "m", 0.092, 0.09500002, 5e-6, ""),
        not_determined("d1", "m", 0.1625, "known only together with d6"),
        Parameter("qd_max.2", "rad/s", 2.6, 2.5, None, AT_LEAST, "shoulder"),
    ]
    assert table(rows) == [
        "parameter  model      found               95 % interval",
        "d6         0.092 m    0.0950000 m         ± 5e-06        differs",
        "d1         0.1625 m                                      not determined: known only together with d6",
        "qd_max.2   2.6 rad/s  at least 2.5 rad/s                 shoulder",
    ]


def test_a_difference_below_a_micrometre_is_none():
    assert not determined("d6", "m", 0.092, 0.0920000005, 1e-12, "").differs
    assert determined("d6", "m", 0.092, 0.0920015, 1e-12, "").differs
    assert not determined("d6", "m", 0.092, 0.095, 0.01, "").differs
