import time

import pytest

from tests.runtime.machine import Bench, run


def logged(body, **options):
    lines = "".join(f"  {line}\n" for line in body.strip("\n").split("\n"))
    bench = run(f"import time\ndef job():\n{lines}job()\n", **options)
    assert bench.alarms == []
    return bench.log


def test_time_is_the_robot_s():
    body = """
textmsg(time.time(), " ", time.monotonic(), " ", time.perf_counter())
time.sleep(2.5)
textmsg(time.time(), " ", time.monotonic(), " ", time.perf_counter())
textmsg(time.time_ns(), " ", time.monotonic_ns())
"""
    assert logged(body) == [
        "1704067200.0 0.0 0.0",
        "1704067202.5 2.5 2.5",
        "1704067202500000000 2500000000",
    ]


def test_the_zone_is_utc():
    body = """
textmsg(time.strftime("%Y-%m-%d %H:%M:%S %Z"))
textmsg(time.localtime().tm_hour, time.gmtime(0).tm_year, time.timezone, time.tzname)
textmsg(time.ctime(0), "|", time.asctime(time.gmtime(0)), "|", time.asctime())
textmsg(time.mktime(time.gmtime(1e9)))
textmsg(time.strptime("2020-02-03", "%Y-%m-%d").tm_yday)
"""
    log = logged(body)
    assert log[0].startswith("2024-01-01 00:00:00")
    assert log[1:] == [
        "019700('UTC', 'UTC')",
        "Thu Jan  1 00:00:00 1970|Thu Jan  1 00:00:00 1970|Mon Jan  1 00:00:00 2024",
        "1000000000.0",
        "34",
    ]


@pytest.fixture
def far_away(monkeypatch):
    """The computer is in a place far from UTC that has a summer time."""
    if not hasattr(time, "tzset"):
        pytest.skip("the zone of this system cannot be changed")
    monkeypatch.setenv("TZ", "NZST-12NZDT,M9.5.0,M4.1.0/3")
    time.tzset()
    yield
    monkeypatch.undo()
    time.tzset()


@pytest.mark.usefixtures("far_away")
class TestFarAway:
    @pytest.mark.parametrize(
        ("expression", "value"),
        [
            ("datetime.datetime(1970, 1, 2).strftime('%s')", "86400"),
            ("datetime.date(1970, 1, 2).strftime('%s %%s')", "86400 %s"),
            ("f'{datetime.datetime(1970, 1, 2):%s}'", "86400"),
            ("datetime.datetime.now().strftime('%s')", "1704067200"),
            ("datetime.datetime.now().astimezone().isoformat()", "2024-01-01T00:00:00+00:00"),
            ("datetime.datetime.now().astimezone().tzname()", "UTC"),
            ("datetime.datetime(1970, 1, 2).timestamp()", "86400.0"),
            ("datetime.datetime.fromtimestamp(86400)", "1970-01-02 00:00:00"),
            ("datetime.date.fromtimestamp(86400)", "1970-01-02"),
            ("datetime.datetime.strptime('5 UTC', '%H %Z')", "1900-01-01 05:00:00"),
            ("time.strftime('%s %Z %z')", "1704067200 UTC +0000"),
            ("time.strftime('%s %Z %z', (2024, 7, 1, 0, 0, 0, 0, 183, 1))", "1719792000 UTC +0000"),
            ("time.strftime('%Z', time.strptime('2024', '%Y'))", "UTC"),
            ("time.strftime('%%Z %-d %%%s%', time.gmtime(0))", "%Z 1 %0%"),
            ("time.strftime('%_s|%-s|%-Z|%^Z|%Es|%03s', time.gmtime(5))", "5|5|UTC|UTC|5|5"),
            ("time.mktime(time.localtime(86400))", "86400.0"),
            ("time.mktime(time.strptime('2024-07-01', '%Y-%m-%d'))", "1719792000.0"),
            ("time.strptime('UTC', '%Z').tm_isdst", "0"),
            ("time.strptime('-0330', '%z').tm_gmtoff", "-12600"),
            ("time.strftime('%z %Z', time.strptime('-0330', '%z'))", "-0330 UTC"),
            ("time.localtime(0).tm_zone + str(time.localtime(0).tm_gmtoff)", "UTC0"),
            ("time.ctime(0)", "Thu Jan  1 00:00:00 1970"),
        ],
    )
    def test_the_zone_is_utc(self, expression, value):
        assert logged(f"import datetime\ntextmsg({expression})") == [value]

    @pytest.mark.parametrize("call", ["time.strptime('NZST', '%Z')", "datetime.datetime.strptime('NZST', '%Z')"])
    def test_the_name_of_the_computer_s_zone_means_nothing(self, call):
        assert run(f"import datetime, time\n{call}\n").alarms[0].class_name == "ValueError"

    @pytest.mark.parametrize("parts", ["()", "(2024, 1)", "'x'", "5", "(2024, 13, 1, 0, 0, 0, 0, 1, 0)"])
    def test_parts_that_are_no_time_are_refused(self, parts):
        assert run(f"import time\ntime.strftime('%s', {parts})\n").alarms[0].class_name in ("TypeError", "ValueError")


@pytest.mark.parametrize(("value", "error"), [("-1", "ValueError"), ("'x'", "TypeError")])
def test_a_sleep_must_be_a_time(value, error):
    assert run(f"import time\ntime.sleep({value})\n").alarms[0].class_name == error


def test_a_sleep_gives_way():
    bench = Bench().start("""
        import time
        def job():
          def other():
            textmsg("other")
          start_thread(other, ())
          time.sleep(0.01)
          textmsg("main")
        job()
    """)
    assert bench.run().log == ["other", "main"]


def test_a_busy_wait_for_the_clock_ends():
    bench = Bench(work_per_tick=100).start("import time\nwhile time.time() < 1704067200.1:\n  pass\n").run()
    assert (bench.ends, bench.machine.tick) == (["finished"], 25)


def test_dates_come_from_the_same_clock():
    body = """
import datetime
time.sleep(90061)
now = datetime.datetime.now()
textmsg(now, "|", datetime.date.today(), "|", datetime.datetime.utcnow(), "|", now.date().today())
textmsg(now - datetime.timedelta(days=1), "|", datetime.datetime.now(datetime.timezone.utc).isoformat())
textmsg(datetime.datetime.strptime("2020-02-03 04:05", "%Y-%m-%d %H:%M") < now)
textmsg(repr(datetime.datetime(2020, 1, 2)), isinstance(now, datetime.date))
textmsg(datetime.datetime.fromtimestamp(0), "|", now.strftime("%d.%m.%y"))
"""
    assert logged(body, until=10**9) == [
        "2024-01-02 01:01:01|2024-01-02|2024-01-02 01:01:01|2024-01-02",
        "2024-01-01 01:01:01|2024-01-02T01:01:01+00:00",
        "True",
        "datetime.datetime(2020, 1, 2, 0, 0)True",
        "1970-01-01 00:00:00|02.01.24",
    ]


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("time.ctime(time.mktime((-100, 1, 10, 0, 0, 0, 0, 0, 0)))", "Wed Jan 10 00:00:00 -100"),
        ("time.mktime((12345, 1, 10, 0, 0, 0, 0, 0, 0))", "327404160000.0"),
        ("time.mktime((2024, 14, 32, 0, 0, 0, 0, 0, 0))", "1741046400.0"),
        ("time.mktime((2024, 0, 1, 0, 0, 0, 0, 0, 0))", "1701388800.0"),
        ("time.gmtime(time.mktime((0, 3, 1, 0, 0, 0, 0, 0, 0)))[:3]", "(0, 3, 1)"),
        ("time.gmtime(time.mktime((400, 2, 29, 0, 0, 0, 0, 0, 0)))[:3]", "(400, 2, 29)"),
    ],
)
def test_years_far_away_and_months_past_the_year(expression, value):
    assert logged(f"textmsg({expression})") == [value]


@pytest.mark.parametrize(
    ("call", "text"),
    [
        ("time.strftime(b'%Y')", "strftime() argument 1 must be str, not bytes"),
        ("time.mktime((1, 2))", "mktime(): illegal time tuple argument"),
        ("time.mktime(5)", "Tuple or struct_time argument required"),
    ],
)
def test_errors_of_times_have_the_texts_of_python(call, text):
    assert logged(f"try:\n  {call}\nexcept TypeError as e:\n  textmsg(e)") == [text]
