import pytest

from elitescript.errors import UsageError
from elitescript.messages.signals import SIGNALS, parse_signal_name, signal_name


def test_every_point_has_a_name_that_is_read_back():
    for row in SIGNALS.values():
        for index in range(row.size):
            assert parse_signal_name(signal_name(row, index)) == (row, index)


def test_a_family_of_one_is_written_without_index():
    assert signal_name(SIGNALS["tool_analog_in"], 0) == "tool_analog_in"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("standard_digital_in", "needs an index"),
        ("standard_digital_in[16]", "indices 0 to 15"),
        ("standard_digital_in[-1]", "as a number in brackets"),
        ("standard_digital_in[x]", "as a number in brackets"),
        ("standard_digital_in[3", "as a number in brackets"),
        ("digital_in[3]", "no signal is called 'digital_in'"),
    ],
)
def test_a_wrong_name_is_refused_with_the_reason(text, words):
    with pytest.raises(UsageError, match="." if not words else words.replace("[", r"\[")):
        parse_signal_name(text)


def test_defaults_have_the_kind_of_their_row():
    kinds = {"bool": bool, "int": int, "float": float}
    assert all(type(row.default) is kinds[row.kind] for row in SIGNALS.values())
