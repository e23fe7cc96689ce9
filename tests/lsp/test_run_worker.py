"""What a run in the background records, and what it cannot reach."""

from __future__ import annotations

import pytest

from elitescript.assist.last_run import LineTime
from elitescript.lsp.run_data import decoded, encoded
from elitescript.lsp.run_worker import outcome_of

PROGRAM = """\
def p():
  def twice(n):
    doubled = 2 * n
    if n > 1:
      twice(n - 1)
    end
    return doubled
  end
  movej([0, -1.5, 0, -1.57, 0, 0])
  sleep(1)
  got = twice(3)
  twice(1)
end
"""


def outcome(text, **more):
    return outcome_of({"text": text, "name": "a.script", "folder": None, **more}, is_jailed=False)


def test_it_records_moves_times_calls_and_values():
    found = outcome(PROGRAM)
    last = decoded(found["last"])
    assert found["report"]["state"] == "finished"
    assert last.text == PROGRAM
    [(line, move)] = last.moves.items()
    assert (line, move.times) == (9, 1)
    assert last.duration_s == pytest.approx(move.total_s + 1.0)
    assert last.lines[10].total_s == pytest.approx(1.0)
    assert last.lines[3] == LineTime(4, 0.0)
    assert last.values[""]["got"] == "6"
    assert last.values["twice"] == {"n": "1", "doubled": "2"}
    assert decoded(encoded(last)) == last


def test_an_alarm_is_recorded_with_what_came_before_it():
    found = outcome("def p():\n  x = 1\n  movej([0, -1.5, 0, -1.57, 0, 0])\n  y = 1 / 0\nend\n")
    last = decoded(found["last"])
    assert found["report"]["state"] == "alarm"
    assert [(alarm.line, alarm.code) for alarm in last.alarms] == [(4, found["report"]["alarms"][0]["code"])]
    assert last.values[""]["x"] == "1"
    assert set(last.moves) == {3}


def test_a_shortened_blend_is_recorded():
    here, there = "[0, -1.5, 0, -1.57, 0, 0]", "[0.05, -1.5, 0, -1.57, 0, 0]"
    text = f"def p():\n  movej({here})\n  movej({there}, r=0.5)\n  movej({here})\nend\n"
    blends = decoded(outcome(text)["last"]).blends
    assert set(blends) == {3}
    assert blends[3].asked_m == 0.5
    assert 0.0 < blends[3].used_m < 0.1


@pytest.mark.parametrize(
    ("text", "state"),
    [
        ("def p():\n  x = (\nend\n", "does_not_compile"),
        ("def p():\n  while True:\n    sync()\n  end\nend\n", "time_limit"),
    ],
)
def test_how_it_ended_is_said(text, state):
    assert outcome(text, wall_s=0.05)["report"]["state"] == state


def test_a_run_that_takes_too_long_has_what_happened_until_then():
    found = outcome(
        "def p():\n  while True:\n    movej([0, -1.5, 0, -1.57, 0, 0])\n    x = 1\n  end\nend\n", wall_s=0.05
    )
    assert decoded(found["last"]).moves


def test_a_world_file_that_makes_no_sense_is_said(tmp_path):
    (tmp_path / "cell.toml").write_text("[nonsense]\n", encoding="utf-8")
    report = outcome("def p():\n  x = 1\nend\n", world=str(tmp_path / "cell.toml"))["report"]
    assert report["state"] == "does_not_run"
    assert "[nonsense] is not known" in report["problems"][0]


@pytest.mark.parametrize(
    "world",
    ['[world]\nnetwork = "real"\n', '[[device]]\nclass = "cell.py:Button"\n'],
)
def test_neither_the_network_nor_python_of_a_world_file_is_used(tmp_path, world):
    (tmp_path / "cell.toml").write_text(world, encoding="utf-8")
    (tmp_path / "cell.py").write_text("raise AssertionError('it ran')\n", encoding="utf-8")
    report = outcome("def p():\n  x = 1\nend\n", world=str(tmp_path / "cell.toml"))["report"]
    assert report["state"] == "does_not_run"
    assert "not allowed" in report["problems"][0]


def test_files_are_read_from_a_copy_and_never_written(tmp_path):
    (tmp_path / "points.csv").write_text("12", encoding="utf-8")
    text = (
        'def p():\n  f = open("points.csv", "r+")\n  got = f.read()\n  f.write("3")\n  f.close()\n'
        '  g = open("new.txt", "w")\n  g.write("x")\n  g.close()\nend\n'
    )
    found = outcome(text, folder=str(tmp_path))
    assert found["report"]["state"] == "finished"
    assert found["last"]["values"][""]["got"] == "'12'"
    assert [path.name for path in tmp_path.iterdir()] == ["points.csv"]
    assert (tmp_path / "points.csv").read_text(encoding="utf-8") == "12"


def test_no_connection_leads_outside():
    import socket

    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(0.05)
        port = listener.getsockname()[1]
        found = outcome(f'def p():\n  got = socket_open("127.0.0.1", {port})\nend\n')
        with pytest.raises(TimeoutError):
            listener.accept()
    assert found["last"]["values"][""]["got"] == "False"


def test_a_page_is_made_if_it_is_asked_for():
    assert "page" not in outcome(PROGRAM)
    assert outcome(PROGRAM, with_page=True)["page"].startswith("<!DOCTYPE html>")


def test_a_copy_of_the_folder_that_is_not_whole_is_said(tmp_path):
    for number in range(201):
        (tmp_path / f"{number:03}.txt").write_bytes(b"x")
    found = outcome_of({"text": TEXT_OF_ONE_LINE, "name": "a.script", "folder": str(tmp_path)}, is_jailed=False)
    assert f"a copy of the folder {tmp_path.name} that ends before 200.txt" in found["report"]["warnings"][0]
    (tmp_path / "200.txt").unlink()
    found = outcome_of({"text": TEXT_OF_ONE_LINE, "name": "a.script", "folder": str(tmp_path)}, is_jailed=False)
    assert found["report"]["warnings"] == []


TEXT_OF_ONE_LINE = "def p():\n  sleep(0.1)\nend\n"


@pytest.mark.parametrize(
    ("lines", "text"),
    [
        ("v = list(range(100000))", "… 99,982 more]"),
        ("v = [1]\nv.append(v)", "[1, [1, [1, [1, [1, [1, [1, …]]]]]]]"),
        ("v = 10 ** 5000", "an int of 16610 bits"),
        ("class A():\n  def __repr__(self):\n    while True:\n      pass\n    end\n  end\nend\nv = A()", "<A>"),
        ("v = [0.1, 1/3, 2]", "[0.1, 0.33333, 2]"),
    ],
)
def test_globals_of_any_kind_are_shown_in_part(lines: str, text: str) -> None:
    request = {"text": f"global v\n{lines}\n", "name": "a.script", "options": {}}
    found = outcome_of(request, is_jailed=False)
    assert dict(found["last"]["values"][""])["v"].endswith(text)
