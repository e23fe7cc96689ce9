"""Planes that push back, and the section of a cell file that describes them."""

import tomllib

import pytest

from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.errors import UsageError

UP = (0.0, 0.0, 2.0)
REST = (0.0, 0.0, 0.0)
NOTHING = (0.0,) * 6


def plane(**more):
    return Plane((0.0, 0.0, 0.1), UP, **{"stiffness": 1000.0, **more})


def test_above_the_plane_there_is_nothing():
    assert plane(friction=0.5, damping=9.0).force((5.0, 5.0, 0.1001), (1.0, 1.0, -1.0)) == REST


def test_below_it_the_force_grows_with_the_depth_along_the_normal():
    assert plane().force((5.0, 5.0, 0.09), REST) == pytest.approx((0.0, 0.0, 10.0))


def test_a_leaning_plane_pushes_along_its_normal():
    leaning = Plane((1.0, 0.0, 0.0), (3.0, 0.0, 4.0), 1000.0)
    assert leaning.force((0.9, 7.0, 0.0), REST) == pytest.approx((36.0, 0.0, 48.0))


@pytest.mark.parametrize(("v", "force"), [(-0.1, 15.0), (0.1, 5.0), (0.5, 0.0)])
def test_damping_adds_while_it_goes_in_and_never_pulls(v, force):
    assert plane(damping=50.0).force((0.0, 0.0, 0.09), (0.0, 0.0, v))[2] == pytest.approx(force)


def test_friction_acts_against_the_sliding():
    force = plane(friction=0.5).force((0.0, 0.0, 0.09), (0.3, -0.4, 0.0))
    assert force == pytest.approx((-3.0, 4.0, 10.0))


def test_friction_vanishes_with_the_speed():
    pair = [plane(friction=0.5).force((0.0, 0.0, 0.09), (v, 0.0, 0.0))[0] for v in (0.0, 1e-4)]
    assert pair == pytest.approx([0.0, -0.5])


def test_several_planes_and_what_pushes_besides_add_up():
    side = Plane((0.2, 0.0, 0.0), (-1.0, 0.0, 0.0), 500.0)
    contact = ContactConfig((plane(), side))
    wrench = contact.wrench((0.21, 0.0, 0.09), REST, (1.0, 2.0, 3.0, 4.0, 5.0, 6.0))
    assert wrench == pytest.approx((-4.0, 2.0, 13.0, 4.0, 5.0, 6.0))
    assert ContactConfig().wrench(REST, REST, NOTHING) == NOTHING


def read(text):
    return ContactConfig.from_table(tomllib.loads(text).get("contact", {}))


def test_a_cell_file_describes_the_planes():
    text = """
    [[contact.planes]]
    point = [0, 0, 0.1]
    normal = [0, 0, 2]
    stiffness = 1000
    [[contact.planes]]
    point = [1.0, 0, 0]
    normal = [1, 0, 0]
    damping = 5.0
    friction = 0.1
    """
    assert read(text) == ContactConfig((plane(), Plane((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1e5, 5.0, 0.1)))
    assert read("") == ContactConfig()


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("normal = [0, 0, 1]", r"^\[\[contact.planes\]\] 1: point is missing"),
        ("point = [0, 0, 0]\nnormal = [0, 0, 1]\nstifness = 1", "stifness is no key here; there are point, normal"),
        ("point = [0, 0]\nnormal = [0, 0, 1]", "point of a contact plane needs three finite numbers"),
        ("point = 'here'\nnormal = [0, 0, 1]", "point must be three numbers, got 'here'"),
        ("point = [0, 0, 0]\nnormal = [0, 0, 0]", "normal of a contact plane has no direction"),
        ("point = [0, 0, 0]\nnormal = [0, 0, 1]\nstiffness = true", "stiffness must be a number, got True"),
        ("point = [0, 0, 0]\nnormal = [0, 0, 1]\nstiffness = 0", "stiffness of a contact plane must be > 0 N/m"),
        ("point = [0, 0, 0]\nnormal = [0, 0, 1]\ndamping = -1", "damping of a contact plane must be >= 0 N s/m"),
        ("point = [0, 0, inf]\nnormal = [0, 0, 1]", "finite"),
    ],
)
def test_what_makes_no_sense_is_refused_with_its_place(row, message):
    with pytest.raises(UsageError, match=message) as caught:
        read(f"[[contact.planes]]\n{row}")
    assert str(caught.value).startswith("[[contact.planes]] 1: ")


@pytest.mark.parametrize("text", ["[contact]\nwalls = []", "[contact]\nplanes = 3", "[contact]\nplanes = [1]"])
def test_the_section_itself_is_checked(text):
    with pytest.raises(UsageError, match=r"^\[contact\] (walls|planes) "):
        read(text)
