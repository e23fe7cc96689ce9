import pytest

from elitescript.errors import UsageError
from elitescript.messages.profile import PROFILES, profile, release_of


def test_releases_compare_as_numbers():
    assert release_of("2.9") < release_of("2.10") < release_of("2.14")


def test_a_profile_is_named_by_its_release():
    assert all(release_of(name) == entry.release and entry.name == name for name, entry in PROFILES.items())


def test_an_unknown_firmware_names_the_known_ones():
    with pytest.raises(UsageError, match=r"2\.10, 2\.14"):
        profile("3.0")
