from elitescript.messages.line import LineSettings


def test_a_character_takes_its_bits():
    assert LineSettings(9600, 0, 1, 8).character_s == 10 / 9600
    assert LineSettings(115200, 2, 2, 7).character_s == 11 / 115200
