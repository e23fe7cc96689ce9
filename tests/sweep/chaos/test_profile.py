"""Profiles: named ones, files, and what is refused in a file with its line."""

from __future__ import annotations

import pytest

from elitescript.devices.channels.faults import TABLE
from elitescript.errors import UsageError
from elitescript.sweep.chaos.kinds import KINDS
from elitescript.sweep.chaos.profile import profile_named, profile_of, read_profile
from elitescript.sweep.making import make_plan


def test_every_fault_but_a_reconnect_can_be_drawn() -> None:
    assert {name for name in KINDS if name in TABLE} == set(TABLE) - {"reconnect"}


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("channels", "corrupt delay disconnect drop duplicate refuse silence trickle wrong_reply"),
        ("inputs", "bouncing drifting inverted late noisy open_wire stuck"),
        ("stops", "pause protective_stop reduced_mode safeguard_stop slider"),
        ("people", "early_press no_part push safeguard_stop"),
    ],
)
def test_a_named_profile_has_its_kinds_alone(name: str, kinds: str) -> None:
    assert sorted(profile_named(name).rates) == kinds.split()


def test_all_has_every_kind() -> None:
    assert set(profile_named("all").rates) == set(KINDS)


def test_an_unknown_profile_is_refused_with_the_nearest_one() -> None:
    with pytest.raises(UsageError, match=r"'chanels'; there are channels, inputs, stops, people, all, .*'channels'\?"):
        profile_named("chanels")


def test_a_file_changes_the_rates_of_its_base_and_ranges() -> None:
    text = """
base = "channels"
most = 5
swarm = 1
ends = 0.25
[rates]
drop = 3
pause = 0.5
refuse = 0
[ranges.delay]
delay_s = [0.1, 10]
"""
    profile = read_profile(text, "mine.toml")
    assert (profile.most, profile.swarm, profile.ends) == (5, 1.0, 0.25)
    assert (profile.rates["drop"], profile.rates["pause"], profile.rates["corrupt"]) == (3.0, 0.5, 1.0)
    assert "refuse" not in profile.rates
    assert profile.ranges["delay"]["delay_s"] == (0.1, 10.0)
    assert profile.ranges["delay"]["count"] == profile_named("all").ranges["delay"]["count"]


def test_a_file_without_a_base_has_its_own_rates_alone() -> None:
    assert profile_of("[rates]\ndrop = 1\n").rates == {"drop": 1.0}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("most = 3\n[rates\n", r"p.toml:2: the profile is not TOML"),
        ("mosst = 3\n", r"p.toml:1: mosst: is not known; .*'most'\?"),
        ("base = 'nothing'\n", r"p.toml:1: base: there is no chaos profile 'nothing'"),
        ("[rates]\ndrop = 1\ndropp = 2\n", r"p.toml:3: rates.dropp: is not known; .*'drop'\?"),
        ("[rates]\ndrop = -1\n", r"p.toml:2: rates.drop: must be a number in \[0, 1e\+06\], got -1"),
        ("[rates]\ndrop = true\n", r"p.toml:2: rates.drop: must be a number .*, got True"),
        ("rates = 3\n", r"p.toml:1: rates: must be a table"),
        ("[rates]\ndrop = 0\n", r"p.toml:1: rates: every rate is 0"),
        ("base = 'all'\nmost = 0\n", r"p.toml:2: most: must be a whole number in \[1, 20\], got 0"),
        ("base = 'all'\nswarm = 1.5\n", r"p.toml:2: swarm: must be a number in \[0, 1\], got 1.5"),
        (
            "base = 'all'\n[ranges.delay]\ndelay = [1, 2]\n",
            r"p.toml:3: ranges.delay.delay: is not known; .*'delay_s'\?",
        ),
        ("base = 'all'\n[ranges.delay]\ndelay_s = [2, 1]\n", r"p.toml:3: ranges.delay.delay_s: must be a lower"),
        ("base = 'all'\n[ranges.delay]\ndelay_s = 2\n", r"p.toml:3: ranges.delay.delay_s: must be two numbers"),
    ],
)
def test_what_makes_no_sense_is_refused_with_its_line(text: str, message: str) -> None:
    with pytest.raises(UsageError, match=f"^{message}"):
        read_profile(text, "p.toml")


@pytest.mark.parametrize("text", ["x = \n", "channels", ""])
def test_a_broken_file_is_named_as_it_was_given(tmp_path, text):
    path = tmp_path / "mychaos.toml"
    path.write_text(text)
    with pytest.raises(UsageError, match=r"mychaos\.toml:1: "):
        make_plan("def p():\nend\n", chaos=str(path))
