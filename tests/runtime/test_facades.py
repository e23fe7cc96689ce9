import importlib
import sys
from types import ModuleType

import pytest

from elitescript.language import modules
from elitescript.language.modules import COPIED_NAMES, OWN_NAMES, SHARED_NAMES
from elitescript.runtime.names.identities import STEP
from elitescript.runtime.names.modules import Facade
from elitescript.runtime.names.own_modules import _MAKERS
from tests.runtime.machine import run
from tools.modules_page import LEFT_OUT


def logged(body):
    lines = "".join(f"  {line}\n" for line in body.strip("\n").split("\n"))
    bench = run(f"def job():\n{lines}job()\n")
    assert bench.alarms == []
    return bench.log


def test_every_module_of_the_language_can_be_made_and_no_other():
    assert set(_MAKERS) | {"os.path"} == modules.OWN


@pytest.mark.parametrize("name", sorted(modules.AVAILABLE))
def test_every_module_can_be_imported_and_has_something(name):
    assert logged(f"import {name} as m\ntextmsg(len(dir(m)) > 0, ' ', m)")[0].startswith("True <module")


@pytest.mark.parametrize("name", sorted({*SHARED_NAMES, *COPIED_NAMES}))
def test_every_name_in_the_table_is_one_of_the_module(name):
    """A slip of the pen would show as a missing name, and only when a program asks for it."""
    listed = {**SHARED_NAMES, **COPIED_NAMES}[name]
    real = importlib.import_module(name)
    newer = {"ShutDown", "UTC", "member", "nonmember", "StrEnum", "override"}
    assert listed == "*" or {item for item in listed.split() if not hasattr(real, item)} <= newer


@pytest.mark.skipif(sys.version_info[:2] != (3, 11), reason="the page is about the names of Python 3.11")
@pytest.mark.parametrize("name", sorted({*SHARED_NAMES, *COPIED_NAMES}))
def test_the_page_of_modules_names_all_that_is_left_out(name):
    real = importlib.import_module(name)
    public = getattr(real, "__all__", None) or [item for item in vars(real) if not item.startswith("_")]
    public = {item for item in public if not isinstance(getattr(real, item), ModuleType)}
    found = logged(f"import {name} as m\ntextmsg(' '.join([n for n in dir(m) if n[0] != '_']))")
    left_out = [item for items, _ in LEFT_OUT.get(name, ()) for item in items.split()]
    assert sorted(left_out) == sorted(public - set(found[0].split()))
    listed = {**SHARED_NAMES, **COPIED_NAMES}[name]
    assert listed == "*" or set(found[0].split()) - {"abc"} == {item for item in listed.split() if hasattr(real, item)}


@pytest.mark.parametrize("name", sorted(OWN_NAMES))
def test_the_table_names_what_a_module_of_the_runtime_has(name):
    listed = set(OWN_NAMES[name].split())
    found = logged(f"import {name} as m\ntextmsg(' '.join([n for n in dir(m) if n[0] != '_']))")
    newer = {"batched"} - set(dir(importlib.import_module("itertools")))
    assert set(found[0].split()) == listed - newer


class TestImport:
    @pytest.mark.parametrize(
        ("statement", "expression", "value"),
        [
            ("import math", "math.floor(math.pi)", "3"),
            ("import math as m", "m.sqrt(4)", "2.0"),
            ("from math import pi, floor as f", "f(pi)", "3"),
            ("import collections.abc", "isinstance({}, collections.abc.Mapping)", "True"),
            ("from collections import abc", "isinstance([], abc.Sequence)", "True"),
            ("from collections.abc import Iterable", "isinstance('x', Iterable)", "True"),
            ("import operator", "operator.__lt__(1, 2)", "True"),
            ("import operator", "operator.__eq__(1, 2)", "False"),
            ("import operator", "operator.__add__ is operator.add", "True"),
            ("import operator", "operator.__and__(6, 3)", "2"),
            ("from operator import __ne__ as differs", "differs(1, 2)", "True"),
            ("import os.path as p", "p.join('a', 'b')", "a/b"),
            ("import json, struct", "json.loads(json.dumps(struct.unpack('<h', b'ab')))", "[25185]"),
            ("import decimal", "decimal.Decimal('0.1') + decimal.Decimal('0.2')", "0.3"),
            ("import fractions", "fractions.Fraction(1, 3) + 1", "4/3"),
            ("import statistics", "statistics.median([3, 1, 2])", "2"),
            ("import hashlib", "hashlib.md5(b'x').hexdigest()[:8]", "9dd4e461"),
            ("import base64", "base64.b64encode(b'abc')", "b'YWJj'"),
            ("import binascii", "binascii.crc32(b'abc')", "891568578"),
            ("import textwrap", "textwrap.shorten('hello world', 8, placeholder='')", "hello"),
            ("import string", "string.Template('$a').substitute(a=1) + string.digits[:2]", "101"),
            ("import operator", "operator.itemgetter(1)([4, 5])", "5"),
            ("import heapq", "heapq.nsmallest(2, [3, 1, 2])", "[1, 2]"),
            ("import bisect", "bisect.bisect([1, 3], 2)", "1"),
            ("import cmath", "cmath.sqrt(-1)", "1j"),
            ("import copy", "copy.deepcopy([[1]])", "[[1]]"),
            ("import elicopy", "elicopy.copy([1])", "[1]"),
            ("import functools", "functools.reduce(lambda a, b: a + b, [1, 2])", "3"),
            ("import collections", "collections.Counter('aab').most_common(1)", "[('a', 2)]"),
            ("import collections", "collections.deque([1, 2], 1)", "deque([2], maxlen=1)"),
            ("import enum", "list(enum.Enum('C', 'A B'))", "[<C.A: 1>, <C.B: 2>]"),
        ],
    )
    def test_every_way_of_importing_works(self, statement, expression, value):
        assert logged(f"{statement}\ntextmsg({expression})") == [value]

    def test_a_module_is_made_once_for_each_program(self):
        assert logged("import json as a\ndef f():\n  import json as b\n  textmsg(a is b)\nf()") == ["True"]

    @pytest.mark.parametrize("name", ["ctypes", "shutil", "nothing_like_it", "os.nothing"])
    def test_others_are_refused_by_name(self, name):
        (alarm,) = run(f"import {name}\n").alarms
        assert alarm.class_name == "ImportError"
        assert alarm.text == f"the module {name!r} is not available to programs"

    @pytest.mark.parametrize("name", ["socket", "xmlrpc.client", "urllib.request"])
    def test_the_network_is_reached_by_commands(self, name):
        assert "socket_open" in run(f"import {name}\n").alarms[0].text

    def test_a_name_that_the_module_does_not_have(self):
        (alarm,) = run("from json import decoder\n").alarms
        assert alarm.text == "cannot import name 'decoder' from 'json': the robot's json does not have it"

    def test_relative_imports_mean_nothing(self):
        assert "whole name" in run("from . import x\n").alarms[0].text


class TestFacade:
    def test_a_wrong_name_brings_the_right_one(self):
        assert run("import math\nmath.sqr(2)\n").alarms[0].text.endswith("has no 'sqr'; is `sqrt` meant?")
        assert "; it has bisect, " in run("import bisect\nbisect.find\n").alarms[0].text

    def test_it_cannot_be_changed(self):
        facade = Facade("m", {"a": 1})
        with pytest.raises(AttributeError, match="cannot be changed"):
            facade.a = 2
        with pytest.raises(AttributeError, match="cannot be changed"):
            del facade.a
        assert (facade.a, repr(facade)) == (1, "<module 'm'>")

    def test_two_programs_do_not_share_copies(self):
        body = "import json\njson.JSONEncoder.mark = getattr(json.JSONEncoder, 'mark', 0) + 1\n"
        body += "textmsg(json.JSONEncoder.mark)"
        assert logged(body) == ["1"]
        assert logged(body) == ["1"]


class TestOwnVersions:
    def test_wraps_takes_name_and_text(self):
        body = """
import functools
def wrap(f):
  @functools.wraps(f)
  def inner(*args):
    return f(*args) + 1
  return inner
@wrap
def work(x):
  "does it"
  return x
textmsg(work(1), work.__name__, work.__doc__)
"""
        assert logged(body) == ["2workdoes it"]

    def test_texts_can_be_extended(self):
        body = """
import collections
class Name(collections.UserString):
  def shout(self):
    return self.upper() + "!"
n = Name("tool")
textmsg(n.shout(), type(n.shout()) is Name, n == "tool", n % (), len(n), n[1:], {n: 1}["tool"], f"{n}")
"""
        assert logged(body) == ["TOOL!TrueTruetool4ool1tool"]

    @pytest.mark.parametrize("name", ["format", "format_map"])
    def test_format_strings_in_them_are_not_filled(self, name):
        (alarm,) = run(f"import collections\ncollections.UserString('{{0.real}}').{name}(1)\n").alarms
        assert alarm.class_name == "AttributeError"

    @pytest.mark.parametrize(
        ("module", "name"),
        [("functools", "singledispatch"), ("dataclasses", "make_dataclass"), ("typing", "get_type_hints")],
    )
    def test_what_would_go_round_the_compiler_is_refused_by_name(self, module, name):
        (alarm,) = run(f"import {module}\n{module}.{name}\n").alarms
        assert alarm.text.startswith(f"the module {module!r} of the robot has no {name!r}")
        (alarm,) = run(f"from {module} import {name}\n").alarms
        assert alarm.text == f"cannot import name {name!r} from {module!r}: the robot's {module} does not have it"

    def test_mistakes_in_json_can_be_caught(self):
        body = """
import json
for text in ("{", '"open', "[1,]", "nul"):
  try:
    json.loads(text)
  except json.JSONDecodeError as e:
    textmsg(e.lineno)
"""
        assert logged(body) == ["1"] * 4

    def test_caches_work(self):
        body = """
import functools
calls = []
@functools.lru_cache(maxsize=None)
def f(n):
  calls.append(n)
  return n * 2
class C:
  @functools.cached_property
  def value(self):
    calls.append("value")
    return 7
c = C()
textmsg(f(2), f(2), c.value, c.value, calls)
"""
        assert logged(body) == ["4477[2, 'value']"]

    def test_data_classes_work(self):
        body = """
from dataclasses import dataclass, field, replace, asdict
@dataclass(order=True, frozen=True)
class Point:
  x: float
  y: float = 0.0
  tags: list = field(default_factory=list, compare=False)
p = Point(1, 2)
textmsg(str(p).split('.')[-1], p < Point(2), asdict(replace(p, x=5)))
try:
  p.x = 3
except AttributeError as e:
  textmsg(type(e).__name__)
"""
        assert logged(body) == ["Point(x=1, y=2, tags=[])True{'x': 5, 'y': 2, 'tags': []}", "FrozenInstanceError"]

    def test_enumerations_work(self):
        body = """
import enum
class Colour(enum.Enum):
  RED = 1
  GREEN = enum.auto()
class Flags(enum.IntFlag):
  A = 1
  B = 2
textmsg(Colour.GREEN.value, Colour(1).name, [c.name for c in Colour], Flags.A | Flags.B == 3, Colour["RED"])
"""
        assert logged(body) == ["2RED['RED', 'GREEN']TrueColour.RED"]

    def test_decimal_contexts_end_with_the_thread(self):
        body = """
import decimal
decimal.getcontext().prec = 3
textmsg(decimal.Decimal(1) / 3)
"""
        assert logged(body) == ["0.333"]
        import decimal

        assert decimal.getcontext().prec == 28


def test_copies_note_what_id_gives_where_a_program_can_see_it():
    """Otherwise they note addresses, which takes less time."""
    bench = run(
        "global a\nimport copy\na = [1]\nmemo = {id(a): 'known'}\ntextmsg(copy.deepcopy([a], memo))\n"
        "exec('global Own\\nclass Own:\\n  def __deepcopy__(self, memo):\\n    memo[id(a)] = 2"
        "\\n    return copy.deepcopy(a, memo)')\n"
        "textmsg(copy.deepcopy(Own()))\n"
    )
    assert bench.log == ["['known']", "2"]


@pytest.mark.parametrize("name", ["copy", "elicopy"])
def test_copies_of_which_a_program_sees_nothing_number_nothing(name):
    bench = run(f"a = [[1], {{}}]\nb = {name}.deepcopy(a)\nb[0].append(2)\ntextmsg(a, b)\ntextmsg(id(a))\n")
    assert bench.log == ["[[1], {}][[1, 2], {}]", str(STEP)]
