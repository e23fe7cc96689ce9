"""`datetime` is that of Python: its errors, the types of its results, its hashes."""

import datetime

import pytest

from tests.runtime.machine import run


def logged(body):
    lines = "".join(f"  {line}\n" for line in body.strip("\n").split("\n"))
    bench = run(f"def job():\n{lines}job()\n")
    assert bench.alarms == []
    return bench.log


@pytest.mark.parametrize(
    "call",
    [
        "date(0, 1, 1)",
        "date(2023, 2, 29)",
        "time(25)",
        "date.fromordinal(0)",
        "date.max + timedelta(1)",
        "timedelta(-1000000000)",
        "timedelta(1) + 1",
        "timezone.utc.dst('x')",
        "date.fromisoformat('2009-01-32')",
        "datetime.fromisoformat('123456789')",
        "datetime(1, 1, 1, tzinfo=5)",
        "datetime.now(5)",
        "datetime.now(None, 5)",
        "datetime.utcnow(1)",
        "date.today(1)",
        "datetime.fromtimestamp()",
        "datetime.fromtimestamp(1, tz=5)",
        "datetime.fromtimestamp(float('nan'))",
        "datetime(1, 1, 1).strftime()",
        "date.strftime(date(1, 1, 1), 5)",
        "datetime.strptime(5, '%Y')",
        "datetime(1, 1, 1) < datetime.now(timezone.utc)",
        "datetime(1, 1, 1).astimezone(5)",
        "time(1).isoformat(foo=3)",
    ],
)
def test_errors_have_the_texts_of_python(call):
    with pytest.raises(Exception) as error:
        eval(call, dict(vars(datetime)))
    body = f"""
from datetime import date, datetime, time, timedelta, timezone
try:
  {call}
except {error.type.__name__} as e:
  textmsg(e)
"""
    assert logged(body) == [str(error.value)]


@pytest.mark.parametrize(
    ("expression", "kind"),
    [
        ("datetime.datetime.now()", "datetime"),
        ("datetime.datetime.now() + datetime.timedelta(1)", "datetime"),
        ("datetime.datetime.now(datetime.timezone.utc).astimezone()", "datetime"),
        ("datetime.datetime.strptime('1', '%d')", "datetime"),
        ("datetime.datetime.combine(datetime.date.min, datetime.time.max)", "datetime"),
        ("datetime.datetime.fromisoformat('2024-01-01').replace(year=3)", "datetime"),
        ("datetime.datetime.max", "datetime"),
        ("copy.deepcopy(datetime.datetime.min)", "datetime"),
        ("datetime.datetime.now().date()", "date"),
        ("datetime.date.today() - datetime.timedelta(1)", "date"),
        ("datetime.date.max", "date"),
        ("datetime.datetime.now().time()", "time"),
        ("datetime.datetime.now().timetz()", "time"),
        ("datetime.time.max", "time"),
        ("datetime.time.fromisoformat('10:00')", "time"),
        ("Later.now()", "Later"),
        ("Later.now() + datetime.timedelta(1)", "Later"),
        ("Later.fromtimestamp(5)", "Later"),
        ("Later.fromtimestamp(5, datetime.timezone.utc)", "Later"),
        ("Later.strptime('1', '%d')", "Later"),
        ("Later.today().astimezone()", "Later"),
        ("Later.now().date()", "date"),
    ],
)
def test_results_have_the_types_of_python(expression, kind):
    body = f"""
import copy, datetime
class Later(datetime.datetime):
  pass
value = {expression}
textmsg(type(value).__name__, " ", type(value) is {kind if kind == "Later" else "datetime." + kind})
"""
    assert logged(body) == [f"{kind} True"]


def test_representations_are_those_of_python():
    body = """
import datetime
class Later(datetime.datetime):
  pass
moment = datetime.datetime(2024, 2, 29, 1, 2, tzinfo=datetime.timezone.utc)
textmsg([moment, moment.date(), moment.timetz(), moment - moment, Later(1, 2, 3)])
textmsg(datetime.date, " ", datetime.datetime.min, " ", datetime.time.max)
"""
    assert logged(body) == [
        "[datetime.datetime(2024, 2, 29, 1, 2, tzinfo=datetime.timezone.utc), datetime.date(2024, 2, 29),"
        " datetime.time(1, 2, tzinfo=datetime.timezone.utc), datetime.timedelta(0), Later(1, 2, 3, 0, 0)]",
        "<class 'datetime.date'> 0001-01-01 00:00:00 23:59:59.999999",
    ]


def test_hashes_and_comparisons_are_those_of_python():
    zone = datetime.timezone(datetime.timedelta(minutes=99))
    moments = (datetime.datetime(2024, 2, 29, 5, tzinfo=zone), datetime.time(5, 1, tzinfo=zone), datetime.date(1, 2, 3))
    body = """
import datetime
zone = datetime.timezone(datetime.timedelta(minutes=99))
later = datetime.datetime(2024, 2, 29, 5, tzinfo=zone)
for moment in (later, datetime.time(5, 1, tzinfo=zone), datetime.date(1, 2, 3)):
  textmsg(hash(moment))
textmsg(datetime.datetime(1, 1, 1) == datetime.date(1, 1, 1), datetime.date(1, 1, 1) in {datetime.date.min})
"""
    assert logged(body) == [*(str(hash(moment)) for moment in moments), "FalseTrue"]


def test_a_class_of_a_program_is_made_once_for_each_moment():
    body = """
import datetime
class Counted(datetime.datetime):
  def __init__(self, *fields, **options):
    textmsg(len(fields))
Counted.now()
Counted.fromtimestamp(0)
Counted(1, 2, 3).timestamp()
"""
    assert logged(body) == ["8", "8", "3"]


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("datetime.datetime.fromtimestamp(1.9999999)", "1970-01-01 00:00:02"),
        ("datetime.datetime.fromtimestamp(-0.5)", "1969-12-31 23:59:59.500000"),
        ("datetime.date.fromtimestamp(-0.5)", "1969-12-31"),
        ("datetime.date.fromtimestamp(86399.9999999)", "1970-01-01"),
        ("datetime.datetime.fromtimestamp(timestamp=7, tz=None)", "1970-01-01 00:00:07"),
        ("datetime.datetime(1969, 12, 31, 23, 59, 59, 500000).timestamp()", "-0.5"),
        ("datetime.time(0, 0, 1).strftime('%s %H')", "-2208988799 00"),
        ("datetime.datetime.now(tz=datetime.timezone(datetime.timedelta(hours=2)))", "2024-01-01 02:00:00+02:00"),
        ("datetime.datetime(2024, 1, 1).astimezone(datetime.timezone.utc).isoformat()", "2024-01-01T00:00:00+00:00"),
    ],
)
def test_moments(expression, value):
    assert logged(f"import datetime\ntextmsg({expression})") == [value]
