from __future__ import annotations

from tests.lint.checking import body, found, marked, only


def test_a_call_of_the_program_itself_is_found():
    assert body("job()") == ["W208 2:3"]
    assert marked("def job():\n  job()\nend\n") == "job"


def test_any_use_counts():
    assert body("start_thread(job, ())") == ["W208 2:16"]


def test_a_function_of_the_same_name_is_something_else():
    assert body("def job():", "  pass", "end", "job()") == []


def test_a_command_of_the_same_name_is_something_else():
    assert found("def sync():\n  sync()\nend\n") == []


def test_a_secondary_program_cannot_call_itself_either():
    assert found("sec lamp():\n  lamp()\nend\n") == ["W208 2:3"]


def test_a_call_behind_the_program_is_found():
    assert found("def job():\n  textmsg(1)\nend\njob()\n") == ["W208 4:1"]
    assert found("'text'\ndef job():\n  textmsg(1)\nend\njob()\njob()\n") == ["W208 5:1", "W208 6:1"]
    assert "script port" in only("def job():\n  textmsg(1)\nend\njob()\n").text


def test_a_script_with_functions_may_call_them():
    assert found("def job(n):\n  textmsg(n)\nend\njob(1)\n") == []
    assert found("x = 1\ndef job():\n  textmsg(x)\nend\njob()\n") == []
    assert found("def a1():\n  textmsg(1)\nend\ndef b1():\n  a1()\nend\nb1()\n") == []
    assert found("def job():\n  textmsg(1)\nend\ntextmsg(2)\njob()\n") == []
