import json

from elitescript.cli.main import main

GOOD = "def a():\n  sleep(1)\nend\n"
BAD = "def a():\n  sleep(-1)\n  foo()\nend\n"


def write(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_good_file_is_good(tmp_path, capsys):
    assert main(["check", write(tmp_path, "a.script", GOOD)]) == 0
    assert capsys.readouterr().err.strip() == "1 file checked: 0 errors, 0 warnings"


def test_problems_are_shown_with_file_line_column_and_code(tmp_path, capsys):
    path = write(tmp_path, "b.script", BAD)
    assert main(["check", path]) == 3
    output = capsys.readouterr().out
    assert f"{path}:2:9: error E305" in output
    assert f"{path}:3:3: error E301" in output


def test_json_names_the_file_of_each_problem(tmp_path, capsys):
    paths = [write(tmp_path, "a.script", GOOD), write(tmp_path, "b.script", BAD)]
    assert main(["check", "--json", *paths]) == 3
    records = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(record["file"], record["code"], record["line"]) for record in records] == [
        (paths[1], "E305", 2),
        (paths[1], "E301", 3),
    ]


def test_a_command_of_a_newer_firmware_is_found(tmp_path, capsys):
    path = write(tmp_path, "c.script", "def a():\n  halt()\nend\n")
    assert main(["check", path]) == 0
    assert main(["check", "--firmware", "2.10", path]) == 3
    assert "2.14" in capsys.readouterr().out


def test_warnings_become_errors_only_where_the_robot_refuses(tmp_path, capsys):
    path = write(tmp_path, "d.script", 'def a():\n  print "x"\nend\n')
    assert main(["check", path]) == 0
    assert main(["check", "--strict", path]) == 3


def test_a_missing_file_is_a_usage_error(capsys):
    assert main(["check", "missing.script"]) == 2
    assert "missing.script" in capsys.readouterr().err


def test_a_file_that_is_not_utf_8_is_reported_like_any_problem(tmp_path, capsys):
    path = tmp_path / "e.script"
    path.write_bytes(b"\xff\xfe")
    assert main(["check", str(path)]) == 3
    assert "E002" in capsys.readouterr().out


NOTED = """def job():
  movel([0.4, 0, 0.4, 3.14, 0, 0], r=0.02)
  set_standard_digital_out(0, True)
  movel([0.5, 0, 0.4, 3.14, 0, 0])
end
"""


def test_a_note_is_shown_and_spoils_nothing(tmp_path, capsys):
    path = write(tmp_path, "noted.script", NOTED)
    assert main(["check", str(path)]) == 0
    printed = capsys.readouterr()
    assert ":3:3: note N223: set_standard_digital_out comes 20 mm before the point of line 2" in printed.out
    assert printed.err == "1 file checked: 0 errors, 0 warnings, 1 note\n"
    assert main(["check", "--strict", str(path)]) == 0


def test_a_note_has_its_level_in_every_format(tmp_path, capsys):
    path = write(tmp_path, "noted.script", NOTED)
    main(["check", "--json", str(path)])
    assert json.loads(capsys.readouterr().out)["severity"] == "note"
    main(["check", "--format", "github", str(path)])
    assert capsys.readouterr().out.startswith("::notice ")
    main(["check", "--format", "sarif", str(path)])
    (run,) = json.loads(capsys.readouterr().out)["runs"]
    assert run["results"][0]["level"] == "note"
