"""`sys`, `random`, `itertools`, `re`, `typing` of programs."""

import random
from typing import Optional

import pytest

from tests.runtime.machine import Bench, run


def logged(body, **options):
    lines = "".join(f"  {line}\n" for line in body.strip("\n").split("\n"))
    bench = run(f"def job():\n{lines}job()\n", **options)
    assert bench.alarms == []
    return bench.log


class TestSystem:
    def test_it_tells_the_version_and_no_more(self):
        log = logged("import sys\ntextmsg(sys.version_info[0], sys.platform)\ntextmsg(hasattr(sys, 'modules'))")
        assert log == ["3linux", "False"]

    def test_exit_ends_the_program_and_says_so(self):
        bench = run("import sys\nsys.exit(0)\n")
        assert (bench.ends, bench.warnings) == (["stopped"], ["sys.exit() ends the program like halt()"])


class TestRandom:
    def test_the_run_s_seed_decides(self):
        body = "import random\ntextmsg([random.randint(1, 6) for n in range(5)])\ntextmsg(random.choice('abc'))"
        generator = random.Random(11)
        expected = [str([generator.randint(1, 6) for _ in range(5)]), generator.choice("abc")]
        assert logged(body, seed=11) == expected

    def test_a_seed_of_the_program_s_own(self):
        body = "import random\nrandom.seed(5)\nx = random.random()\nrandom.seed(5)\ntextmsg(x == random.random())"
        assert logged(body) == ["True"]

    def test_nothing_draws_from_the_computer(self):
        body = """
import random
from typing import Optional
random.seed()
textmsg(random.random(), random.Random().random(), random.Random(3).random())
r = random.Random()
r.seed()
textmsg(r.random(), random.gauss(0, 1), random.sample(range(9), 3))
import statistics
textmsg(statistics.NormalDist().samples(1))
"""
        assert logged(body) == logged(body)


class TestItertools:
    @pytest.mark.parametrize(
        ("expression", "value"),
        [
            ("list(itertools.islice(itertools.count(5, 2), 3))", "[5, 7, 9]"),
            ("list(itertools.islice(itertools.count(step=2), 2))", "[0, 2]"),
            ("list(itertools.islice(itertools.cycle('ab'), 5))", "['a', 'b', 'a', 'b', 'a']"),
            ("list(itertools.cycle([]))", "[]"),
            ("list(itertools.repeat(1, 3))", "[1, 1, 1]"),
            ("list(itertools.repeat(1, times=2))", "[1, 1]"),
            ("list(itertools.chain('ab', [1]))", "['a', 'b', 1]"),
            ("list(itertools.product('ab', repeat=2))[:2]", "[('a', 'a'), ('a', 'b')]"),
        ],
    )
    def test_it_does_what_python_s_does(self, expression, value):
        assert logged(f"import itertools\ntextmsg({expression})") == [value]

    @pytest.mark.parametrize(
        "endless",
        ["max(itertools.count())", "sum(itertools.repeat(1))", "list(zip(itertools.cycle('ab'), itertools.count()))",
         "set(map(abs, itertools.count()))"],
    )  # fmt: skip
    def test_what_never_ends_can_be_stopped(self, endless):
        bench = Bench(work_per_tick=100).start(f"import itertools\nx = {endless}\n")
        bench.run(until=10)
        bench.host.stop("enough")
        bench.run(until=12)
        assert bench.ends == ["stopped"]

    def test_wrong_arguments_are_refused(self):
        assert run("import itertools\nitertools.count(a=1)\n").alarms[0].class_name == "TypeError"
        assert run("iter(3, 4)\n").alarms[0].class_name == "TypeError"


class TestPatterns:
    def test_it_finds_what_python_s_finds(self):
        body = r"""
import re
m = re.match(r"(?P<name>\w+)=(\d+)", "speed=250")
textmsg(m.group("name"), int(m.group(2)), m.span())
textmsg(re.sub("a", "b", "AaA", flags=re.I), re.findall("[0-9]+", "1,22"), re.split(",", "a,b"))
p = re.compile("^x$", re.M | re.IGNORECASE)
textmsg(len(p.findall("x\nX\ny")), p.pattern, isinstance(m, re.Match), isinstance(p, re.Pattern))
try:
  re.compile("(")
except re.error:
  textmsg("bad pattern")
"""
        assert logged(body) == ["speed250(0, 9)", "bbb['1', '22']['a', 'b']", "2^x$TrueTrue", "bad pattern"]


class TestTyping:
    def test_annotations_mean_nothing(self):
        body = """
from typing import Any, Dict, Generic, List, NamedTuple, NewType, Optional, Tuple, TypeVar, Union, cast, final
T = TypeVar("T")
Metres = NewType("Metres", float)
class Box(Generic[T]):
  value: Optional[int] = 3
def f(a: List[int], b: Union[int, Tuple[int, ...]] = 1) -> Dict[str, Any]:
  x: "Optional[Box]" = Box()
  return x.value + cast(int, a)
textmsg(f(4), Metres(2.0), Optional[int] | None)
Point = NamedTuple("Point", [("x", int), ("y", int)])
textmsg(Point(1, 2).y, Point(1, 2))
"""
        assert logged(body) == [f"72.0{Optional[int]}", "2Point(x=1, y=2)"]  # noqa: UP045

    def test_a_class_of_named_tuples(self):
        body = """
from typing import NamedTuple
class Point(NamedTuple):
  "A place."
  x: int
  y: int = 5
  origin = "flange"
  def sum(self, *more):
    return self.x + self.y + sum(more)
  @property
  def swapped(self):
    return Point(self.y, self.x)
  def __str__(self):
    return f"<{self.x} {self.y}>"
p = Point(1)
textmsg(p.x, p.y, p[1], p == (1, 5), p.sum(1), repr(p.swapped), str(p), Point.origin, Point.__doc__)
textmsg(Point(y=2, x=1)._asdict(), p._replace(x=3).x, Point._make([7, 8]).y, Point._fields, Point._field_defaults)
a, b = p
textmsg(a, b, isinstance(p, Point), isinstance(p, tuple), Point.__name__, len({p, Point(1), (1, 5)}))
class Deep(Point):
  def sum(self):
    return -super().sum()
textmsg(Deep(2).sum(), repr(Deep(2)), copy.deepcopy([p])[0].y)
class Empty(NamedTuple):
  pass
textmsg(Empty())
"""
        assert logged(body) == [
            "155True7Point(x=5, y=1)<1 5>flangeA place.",
            "{'x': 1, 'y': 2}38('x', 'y'){'y': 5}",
            "15TrueTruePoint1",
            "-7Deep(x=2, y=5)5",
            "Empty()",
        ]

    @pytest.mark.parametrize(
        ("lines", "error"),
        [
            ("class P(NamedTuple):\n  x: int = 1\n  y: int", "TypeError"),
            ("class P(NamedTuple):\n  _x: int", "ValueError"),
            ("class P(NamedTuple):\n  def __init__(self):\n    pass", "AttributeError"),
            ("class P(NamedTuple):\n  x: int\n  def _replace(self):\n    pass", "AttributeError"),
            ("class P(NamedTuple, dict):\n  x: int", "TypeError"),
            ("class P(NamedTuple):\n  x: int\nP()", "TypeError"),
            ("class P(NamedTuple):\n  x: int\nP(1).x = 2", "AttributeError"),
            ("class P(NamedTuple):\n  x: int\nP(1).z = 2", "AttributeError"),
            ("NamedTuple('P', [('x', int)], z=int)", "TypeError"),
        ],
    )
    def test_named_tuples_refuse_what_python_s_refuse(self, lines, error):
        assert run(f"from typing import NamedTuple\n{lines}\n").alarms[0].class_name == error

    def test_a_class_of_dicts_with_known_keys(self):
        body = """
from typing import TypedDict, Required
class Pose(TypedDict):
  x: float
  name: str
class Named(Pose):
  tool: str
p = Pose(x=1.0, name="a")
textmsg(p, p["x"], type(p) is dict, Named(p, tool="t"), Pose(), Pose.__name__)
Flat = TypedDict("Flat", {"in": int, "x-y": str}, total=False)
textmsg(Flat({"in": 3}), type(Flat()) is dict)
"""
        assert logged(body) == [
            "{'x': 1.0, 'name': 'a'}1.0True{'x': 1.0, 'name': 'a', 'tool': 't'}{}Pose",
            "{'in': 3}True",
        ]

    @pytest.mark.parametrize(
        ("lines", "error"),
        [
            ("class D(TypedDict, list):\n  x: int", "TypeError"),
            ("class D(TypedDict):\n  x: int\nisinstance({}, D)", "TypeError"),
            ("TypedDict('D', 3)", "TypeError"),
        ],
    )
    def test_they_refuse_what_python_s_refuse(self, lines, error):
        assert run(f"from typing import TypedDict\n{lines}\n").alarms[0].class_name == error

    def test_patterns_and_matches_are_words_of_annotations(self):
        body = (
            "from typing import Match, Optional, Pattern\ndef f(p: Pattern[str]) -> Optional[Match[str]]:\n  return p\n"
        )
        assert logged(body + "textmsg(f(1))") == ["1"]

    @pytest.mark.parametrize("name", ["get_type_hints", "ForwardRef"])
    def test_what_evaluates_text_is_not_there(self, name):
        assert f"has no '{name}'" in run(f"import typing\ntyping.{name}\n").alarms[0].text
