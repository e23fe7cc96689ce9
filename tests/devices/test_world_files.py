"""World files with mistakes: each is refused with file and line, whatever its text is."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from random import Random

import pytest

from elitescript.errors import UsageError
from elitescript.world_file import WorldFile, load_world_file

EXAMPLES = Path(__file__).parents[2] / "examples"
FILES = [path for path in sorted(EXAMPLES.glob("*.toml")) if re.search(r"^\[", path.read_text("utf-8"), re.M)]
SEEDS = 120

VALUES = [
    "[[1]]",
    "{}",
    "{ a = { b = { c = 1 } } }",
    "nan",
    "-inf",
    "1e400",
    "9" * 60,
    "-" + "9" * 400,
    "9" * 5000,
    "0",
    "-1",
    "true",
    "''",
    "'ü\\u0000'",
    '"\\u0000\\uffff"',
    "'standard_digital_in[99]'",
    "'standard_digital_inn[3]'",
    "'5'",
    "1979-05-27T07:32:00Z",
    "07:32:00",
    "[]",
    "[1, 'a', []]",
    "[[0, true], [-1, 7]]",
    "[" * 120 + "]" * 120,
    "[" * 3000 + "]" * 3000,
    "{a=" * 2000 + "1" + "}" * 2000,
    "'" + "(" * 300 + "'",
    "'((((((((((a*)*)*)*)*)*)*)*)*)*)*'",
    "'" + "x" * 3000 + "'",
    "'standard_digital_out[0] and " + "not " * 400 + "true'",
    "'" + "-" * 3000 + "1'",
]
NAMES = ["kind", "on", "form", "port", "line", "class", "name", "", "a b", "ü", "__class__", "cell", "check", "_world"]
EXTRA = [
    "[[fault]]\nkind = 'wrong_reply'\non = 5000\nform = {value}\n",
    "[[fault]]\nkind = {value}\non = 5000\n",
    "[[fault]]\nkind = 'stuck'\non = {value}\n",
    "[[fault]]\nkind = 'noisy'\non = 'standard_analog_in[0]'\nsigma = {value}\n",
    "[[fault]]\nkind = 'bouncing'\non = 'standard_digital_in[0]'\nbounces = {value}\n",
    "[[schedule]]\nsignal = 'standard_digital_in[0]'\nat = {value}\n",
    "[[wire]]\nwhen = {value}\nthen = 'standard_digital_in[0]'\n",
    "[[modbus]]\nport = 5020\nholding_registers = {value}\n",
    "[[tcp]]\nport = 5021\nreplies = {value}\n",
    "[[tcp]]\nport = 5021\nreplies = [{{ match = {value}, send = 'x' }}]\n",
    "[[rpc]]\nport = 5022\nprocedures = {value}\n",
    "[[serial]]\nline = 'box'\nunasked = {value}\n",
    "[[parts]]\nsensor = {value}\n",
    "[contact]\nplanes = {value}\n",
    "[safety]\ntcp_speed = {value}\n",
    "[safety.reduced]\njoint_range = {value}\n",
    "[plant]\nlag_s = {value}\n",
    "[signals]\n'standard_analog_in[0]' = {value}\n",
    "[signals]\n'input_int_register[0]' = {value}\n",
    "[world]\nseed = {value}\n",
    "[world]\nnetwork = {value}\n",
    "[x.{value}]\n",
    "world = {value}\n",
    "fault = {value}\n",
]


def mutated(text: str, random: Random) -> str:
    """A file with one to three mistakes."""
    for _ in range(random.randint(1, 3)):
        lines = text.split("\n")
        keys = [number for number, line in enumerate(lines) if re.match(r"\s*[\w\"'\[\].]+\s*=", line)]
        number = random.choice(keys) if keys else 0
        key, _, value = lines[number].partition("=")
        what = random.randrange(10)
        if what == 0:  # a key renamed
            at = random.randrange(len(key) + 1)
            lines[number] = f"{key[:at]}{random.choice('xü_1.')}{key[at + 1 :]}={value}"
        elif what == 1:
            lines[number] = f"{random.choice(NAMES)} ={value}"
        elif what in (2, 3, 4):  # a value of another type
            lines[number] = f"{key}= {random.choice(VALUES)}"
        elif what == 5:  # a section renamed, nested or repeated
            heads = [number for number, line in enumerate(lines) if line.startswith("[")]
            place = random.choice(heads) if heads else 0
            lines[place] = random.choice(
                ["[wrld]", "[tcp]", "[[world]]", "[[tcp.replies]]", "[safety.x.y]", lines[place]]
            )
        elif what == 6:  # a line twice, or gone
            lines[number : number + 1] = [lines[number]] * random.choice((0, 2))
        elif what == 7:  # a few characters of anything
            at = random.randrange(len(text) + 1)
            text = text[:at] + random.choice(["[", "]", "{", '"', "\\", "\x00", "é", "\n", "=", "#", "'''"]) + text[at:]
            continue
        elif what == 8:
            text = text[: random.randrange(len(text) + 1)]
            continue
        else:
            lines.append(
                random.choice(EXTRA).replace("{value}", random.choice(VALUES)).replace("{{", "{").replace("}}", "}")
            )
        text = "\n".join(lines)
    return text


def outcome(path: Path) -> str:
    """What becomes of a file: empty if it is read, else the refusal."""
    try:
        assert isinstance(load_world_file(path), WorldFile)
    except UsageError as error:
        return str(error)
    return ""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for path in EXAMPLES.glob("*.py"):
        shutil.copy(path, tmp_path)
    return tmp_path


@pytest.mark.parametrize("example", FILES, ids=lambda path: path.stem)
def test_every_mistake_has_file_and_line(example: Path, folder: Path) -> None:
    path, text = folder / "cell.toml", example.read_text(encoding="utf-8")
    refused = 0
    for seed in range(SEEDS):
        wrong = mutated(text, Random(f"{example.stem}/{seed}"))
        path.write_text(wrong, encoding="utf-8")
        found = outcome(path)
        if found:
            refused += 1
            line = re.match(re.escape(str(path)) + r":(\d+): ", found)
            assert line is not None, (seed, found[:300])
            assert 1 <= int(line[1]) <= len(wrong.splitlines()) + 1, (seed, found[:300])
    assert refused > SEEDS / 2


@pytest.mark.parametrize("value", VALUES, ids=range(len(VALUES)))
def test_every_value_in_every_place_has_file_and_line(value: str, folder: Path) -> None:
    path = folder / "cell.toml"
    for extra in EXTRA:
        path.write_text(extra.replace("{value}", value).replace("{{", "{").replace("}}", "}"), encoding="utf-8")
        found = outcome(path)
        assert not found or re.match(re.escape(str(path)) + r":\d+: ", found), (extra, found[:300])


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (
            "[[tcp]]\nport = 1\nname = 'eye'\n[[tcp]]\nport = 2\nname = 'eye'\n",
            6,
            "name: 'eye' is the name .*, see line 1$",
        ),
        (
            "[[tcp]]\nport = 5000\n\n[[rpc]]\nport = 5000\nprocedures = { ready = true }\n",
            5,
            "port: 5000 is taken by tcp 1 already, see line 1$",
        ),
        ("[[serial]]\nline = 'box'\n[[serial]]\nname = 'b'\nline = 'box'\n", 5, "line: .* is taken .*, see line 1$"),
        (
            "[[schedule]]\nsignal = 'flag[0]'\nat = [\n  [1, true],\n  [3, false],\n  [2, true],\n]\n",
            6,
            "at: 2 s is before 3 s of the row above",
        ),
        ("[[tcp]]\nport = 5000\nlatncy_s = 1\n", 3, "latncy_s: is not known; .*did you mean 'latency_s'"),
        ("[[tcpp]]\nport = 5000\n", 1, "did you mean 'tcp'"),
        ("[wrld]\n", 1, "did you mean 'world'"),
        ("[world]\nsed = 1\n", 2, "did you mean 'seed'"),
        ("[safety]\ntcp_sped = 1\n", 2, "did you mean 'tcp_speed'"),
        ("[plant]\nlags = 1\n", 2, "did you mean 'lag_s'"),
        ("[contact]\n[[contact.planes]]\npont = [0, 0, 0]\n", 3, "pont"),
        ("[signals]\n'standard_digital_inn[1]' = true\n", 2, "did you mean 'standard_digital_in'"),
        ("[[wire]]\nwhen = 'standard_digital_out[0]'\nthen = 'standard_digital_inn[0]'\n", 3, "did you mean"),
        ("[[tcp]]\nname = 'camera'\nport = 1\n[[fault]]\nkind = 'drop'\non = 'camra'\n", 6, "did you mean 'camera'"),
        ("[[fault]]\non = 1\nkind = 'stuk'\n", 3, "did you mean 'stuck'"),
        ("[[fault]]\nkind = 'stuck'\non = 'flag[0]'\nfor_s = 1\n", 3, "flag.0. is an output"),
        ("[[tcp]]\nport = 1\n[[fault]]\nkind = 'wrong_reply'\non = 1\nform = [[1]]\n", 6, "form: there is no"),
        ("[[tcp]]\nport = 1\nreplies = [\n  { to = 'a', send = 'b' },\n  { too = 'a' },\n]\n", 5, "too: is not known"),
        ("a = 1\nb = [\n", 2, "not TOML"),
        ("a = 1\nb = " + "9" * 5000 + "\n", 2, "a number of 5000 characters"),
        ("a = 1\nb = " + "9" * 30 + "\n", 2, "b: whole numbers of TOML are within 64 bits"),
        ("a = 1\nb = " + "[" * 9000 + "\n", 2, "nested too deeply"),
    ],
)
def test_a_mistake_is_said_where_it_is(text: str, line: int, words: str, tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(text, encoding="utf-8")
    found = outcome(path)
    assert found.startswith(f"{path}:{line}: "), found
    assert re.search(words, found), found


@pytest.mark.parametrize(
    ("code", "line", "words"),
    [
        ("from elitescript.testing.world import Device\nclass A(Device)\n  pass\n", 2, "SyntaxError"),
        ("import nothing_of_this_name\n", 1, "ModuleNotFoundError"),
        ("from elitescript.testing.world import Device\n\nx = undefined\n", 3, "NameError: name 'undefined'"),
        (
            "from elitescript.testing.world import Device\nclass A(Device):\n  def check(self):\n    return 1 / 0\n",
            4,
            "A cannot be made: ZeroDivisionError",
        ),
    ],
)
def test_a_mistake_in_a_python_file_is_said_where_it_is(code: str, line: int, words: str, tmp_path: Path) -> None:
    (tmp_path / "cell.py").write_text(code, encoding="utf-8")
    path = tmp_path / "cell.toml"
    path.write_text("\n[[device]]\nclass = 'cell.py:A'\n", encoding="utf-8")
    found = outcome(path)
    assert found.startswith(f"{path}:3: [[device]] 1: class: "), found
    assert f"{tmp_path / 'cell.py'}:{line}" in found and words in found, found
