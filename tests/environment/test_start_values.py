import pytest

from elitescript.environment.start_values import parse_settings
from elitescript.errors import UsageError


def test_signals_and_globals_are_told_apart():
    signals, presets = parse_settings(
        ["standard_digital_in[3]=true", "tool_analog_in=5.5", "count=3", "name='a=b'", "grid=[1, 2]", "flag_1=off"]
    )
    assert signals == {"standard_digital_in[3]": True, "tool_analog_in": 5.5}
    assert presets == {"count": 3, "name": "a=b", "grid": [1, 2], "flag_1": False}


@pytest.mark.parametrize("text", ["count", "2x=3", "a.b=1", "count=three", "count=__import__('os')", "=3"])
def test_a_senseless_setting_is_refused(text):
    with pytest.raises(UsageError, match="--set"):
        parse_settings([text])


def test_a_setting_is_called_what_the_command_calls_it():
    with pytest.raises(UsageError, match=r"^set flag=maybe: 'maybe' is no literal"):
        parse_settings(["flag=maybe"], "set")
