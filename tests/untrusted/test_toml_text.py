"""TOML that others wrote: bounds before it is parsed."""

from __future__ import annotations

import time

import pytest

from elitescript.errors import UsageError
from elitescript.untrusted import toml_text
from elitescript.untrusted.toml_text import toml_tables


def refusal(text: str) -> str:
    with pytest.raises(UsageError) as found:
        toml_tables(text, "w.toml", "world file")
    return str(found.value)


REFUSED = {
    "a text": ('\n\na = "' + "x" * 300_000 + '"', "w.toml:3: a text of 300002 characters; at most 250000 are read"),
    "a text that does not end": ('a = """' + '"x' * 200_000, "a text of 400003 characters"),
    "a text of quotes that are escaped": ('a = "' + "\\" * 300_000, "w.toml:1: a text of 300001 characters"),
    "a header": (f"\n[{'.'.join('a' * 5000)}]", "w.toml:2: a name of 5000 parts with dots between; at most 32"),
    "a header in quotes": ("[" + ".".join(["'a.b'"] * 5000) + "]", "w.toml:1: a name of 33 parts with dots"),
    "a key with blanks": (f"{' . '.join('a' * 5000)} = 1", "w.toml:1: a name of 33 parts"),
    "a key": (f"{'a' * 500} = 1", "w.toml:1: a word of 500 characters; at most 400 are read"),
    "a number": (f"\na = {'1' * 5000}", "w.toml:2: a number of 5000 characters; at most 400 are read"),
    "a whole number": ("a = [1,\n{b = 18446744073709551616}]", "w.toml:2: b: whole numbers of TOML are within 64 bits"),
    "lists": ("a = " + "[" * 3000, "w.toml:1: it is nested too deeply: at most 32 brackets within each other"),
    "tables": ("a = " + "{a=" * 3000, "w.toml:1: it is nested too deeply: at most 32 brackets"),
    "tables with dots": (
        "a = " + ("{" + ".".join("a" * 30) + "=") * 30 + "1" + "}" * 30,
        "w.toml:1: it is nested too deeply: at most 64 tables and lists within each other",
    ),
    "elements": ("a = [" + "1," * 200_000, "w.toml:1: the world file goes on behind 300000 words and signs"),
    "lines": ("#\n" * 100_000, "w.toml: the world file has 100001 lines; at most 100000 are read"),
    "no TOML": ("a = 1\nb\n", "w.toml:2: the world file is not TOML: Expected '=' after a key in a key/value pair"),
    "an index without quotes": ("x[3] = 1", 'names with an index stand in quotes: "standard_digital_in[3]" = true'),
}


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused(name: str) -> None:
    text, words = REFUSED[name]
    begin = time.process_time()
    assert words in refusal(text)
    assert time.process_time() - begin < 0.5


def test_what_is_within_the_bounds_is_parsed() -> None:
    deep = "a = " + "[" * toml_text.DEPTH_MAX + "]" * toml_text.DEPTH_MAX
    assert toml_tables(deep, "w.toml", "world file")["a"] != []
    parts = ".".join(f"a{n}" for n in range(toml_text.PARTS_MAX))
    assert toml_tables(f"[{parts}]\n{parts} = '{'x' * 200_000}'", "w.toml", "world file").keys() == {"a0"}
    text = '[[box]]\r\nat = [0.5, -1e3, 0x10]  # ....\r\n"a.b" = """x"""""\r\n'
    assert toml_tables(text, "w.toml", "world file") == {"box": [{"at": [0.5, -1000.0, 16], "a.b": 'x""'}]}


def test_dots_of_numbers_and_comments_are_no_parts_of_names() -> None:
    text = f"a = [{'1.5, ' * 100}]\n# {'. ' * 100}\nb = 'x{'.' * 100}'"
    assert len(toml_tables(text, "w.toml", "world file")["a"]) == 100
