from elitescript.cli.main import main
from elitescript.commands.catalogue import CATALOGUE


def test_the_list_has_every_command(capsys):
    assert main(["commands"]) == 0
    output = capsys.readouterr().out
    assert all(command.name in output for command in CATALOGUE)


def test_one_command_shows_signature_units_and_evidence(capsys):
    assert main(["commands", "movej"]) == 0
    output = capsys.readouterr().out
    for word in ("movej(q, a=1.396263", "rad/s^2", "2.10", "documented"):
        assert word in output


def test_an_unknown_command_names_its_neighbours(capsys):
    assert main(["commands", "movejj"]) == 2
    assert "movej" in capsys.readouterr().err
