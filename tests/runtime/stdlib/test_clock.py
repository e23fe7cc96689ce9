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
