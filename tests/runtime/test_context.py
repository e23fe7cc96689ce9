import pytest

from elitescript.environment.memory import MemoryEnvironment
from elitescript.messages.events import Popup
from tests.runtime.machine import Bench, run


class TestMoves:
    def test_a_move_waits_for_its_end(self):
        bench = run('def a():\n  movej([0,0,0,0,0,0])\n  textmsg("there")\nend\n', move_ticks=50)
        (tick, request, line, thread) = bench.machine.requests[0]
        assert (tick, type(request).__name__, line, thread) == (0, "MoveJ", 2, "main")
        assert [(event.tick, event.text) for event in bench.machine.events] == [(50, "there")]

    def test_a_move_that_is_over_at_once_does_not_wait(self):
        bench = run('def a():\n  movej([0,0,0,0,0,0])\n  textmsg("there")\nend\n', move_ticks=0)
        assert bench.machine.events[0].tick == 0

    def test_a_refused_move_is_an_error_on_its_line(self):
        from elitescript.errors import MotionError

        bench = Bench()

        def refuse(request, line, thread):
            raise MotionError("joint 1 cannot", code="R110", value=9.0)

        bench.machine.request_motion = refuse
        bench.start("def a():\n\n  movej([9,0,0,0,0,0])\nend\n").run()
        assert (bench.alarms[0].code, bench.alarms[0].line) == ("R110", 3)
        assert bench.alarms[0].details["command"] == "movej"

    def test_a_stop_of_another_thread_lets_the_move_return(self):
        bench = run("""
            def a():
              def brake():
                sleep(0.1)
                stopj(2)
              start_thread(brake, ())
              movej([0, 0, 0, 0, 0, 0])
              textmsg("went on")
            end
        """)
        assert bench.log == ["went on"]
        assert bench.host.moves.is_empty


class TestThreads:
    def test_the_limit_is_the_profile_s_and_finished_threads_do_not_count(self):
        text = """
            def a():
              def idle():
                while True:
                  sync()
              def brief():
                pass
              for n in range(40):
                start_thread(brief, ())
                sync()
              n = 0
              while n < 30:
                start_thread(idle, ())
                n += 1
                textmsg(n)
            end
        """
        for firmware, limit in (("2.10", 15), ("2.14", 20)):
            bench = run(text, firmware=firmware)
            assert bench.log[-1] == str(limit)
            (alarm,) = bench.alarms
            assert (alarm.code, alarm.class_name) == ("R121", "RuntimeError")
            assert str(limit) in alarm.text and alarm.details["hint"]

    def test_the_limit_counts_threads_of_the_standard_library_and_start_can_be_tried_again(self):
        bench = run("""
            def a():
              import threading
              gate = threading.Event()
              threads = [threading.Thread(target=gate.wait) for n in range(21)]
              for t in threads[:20]:
                t.start()
              try:
                threads[20].start()
              except RuntimeError as e:
                textmsg("full")
              gate.set()
              for t in threads[:20]:
                t.join()
              threads[20].start()
              threads[20].join()
              textmsg(threading.active_count())
            end
        """)
        assert bench.log == ["full", "1"]

    @pytest.mark.parametrize("handle", ["0", "-5", "123456789", "h"])
    def test_handles_of_nobody_are_silent(self, handle):
        bench = run(f"""
            def a():
              h = start_thread(lambda: 1, ())
              sync()
              stop_thread({handle})
              join_thread({handle})
              textmsg("fine")
            end
        """)
        assert bench.log == ["fine"]

    def test_a_thread_cannot_wait_for_itself(self):
        bench = run("""
            def a():
              global own
              def f():
                join_thread(own)
              own = start_thread(f, ())
              sleep(1)
            end
        """)
        assert (bench.alarms[0].class_name, bench.alarms[0].line) == ("RuntimeError", 4)

    def test_a_thread_that_stops_itself_ends_there(self):
        bench = run("""
            def a():
              global own
              def f():
                stop_thread(own)
                textmsg("never")
              own = start_thread(f, ())
              join_thread(own)
              textmsg("gone")
            end
        """)
        assert bench.log == ["gone"]

    def test_a_secondary_program_is_no_thread_of_the_program(self):
        bench = Bench().start("def a():\n  global h\n  h = 0\n  sleep(1)\n  stop_thread(h)\n  sleep(0.1)\nend\n")
        bench.run(until=5)
        bench.secondary("sec s():\n  global h\n  import threading\n  h = threading.get_ident()\n  "
                        "threading.Event().wait(0.9)\n  textmsg('not stopped')\nend\n")  # fmt: skip
        bench.run()
        assert bench.log == ["not stopped"]

    def test_a_stopped_thread_starts_none(self):
        bench = run("""
            def a():
              def child():
                textmsg("never")
              def parent():
                try:
                  sleep(9)
                finally:
                  start_thread(child, ())
              h = start_thread(parent, ())
              sleep(0.1)
              stop_thread(h)
              sleep(0.1)
            end
        """)
        assert (bench.log, bench.alarms) == ([], [])

    def test_arguments_may_be_a_list(self):
        bench = run("def a():\n  def f(x, y):\n    textmsg(x + y)\n  join_thread(start_thread(f, [1, 2]))\nend\n")
        assert bench.log == ["3"]


class TestPopups:
    def test_one_that_blocks_is_confirmed_at_once_and_says_so(self):
        bench = run('def a():\n  popup("ready?", "Title", blocking=True)\n  textmsg("on")\nend\n')
        assert bench.popups == [Popup(0, "ready?", "Title", "info", True, True, "main", 2)]
        assert bench.log == ["on"]

    def test_somebody_can_be_there_to_press_the_button(self):
        bench = Bench(confirms_popups=False).start('def a():\n  popup("ready?", blocking=True)\n  textmsg("on")\nend\n')
        bench.run()
        assert bench.log == []
        assert not bench.popups[0].is_confirmed_at_once
        assert bench.host.threads()[0].waits_for == "somebody to confirm a popup"
        bench.host.confirm_popup()
        bench.run()
        assert bench.log == ["on"]

    def test_one_that_does_not_block_needs_nobody(self):
        bench = run('popup("hello", warning=True)\n', confirms_popups=False)
        assert (bench.popups[0].level, bench.popups[0].is_confirmed_at_once) == ("warning", False)


def test_a_warning_is_given_once_for_each_program():
    text = "def a():\n  for n in range(3):\n    movel([0.4, 0, 0.4, 0, 0, 0], r=-0.001)\nend\n"
    bench = Bench().start(text).run()
    assert len(bench.warnings) == 1
    bench.start(text).run()
    assert len(bench.warnings) == 2


def test_messages_say_where_they_come_from():
    bench = run("def a():\n  def worker():\n    textmsg('x')\n  start_thread(worker, ())\n  sync()\nend\n")
    (event,) = bench.machine.events
    assert (event.tick, event.thread, event.line, event.level) == (0, "worker", 3, "info")


def test_zero_ticks_do_not_wait():
    bench = run("def a():\n  def t():\n    textmsg('t')\n  start_thread(t, ())\n  sleep(0)\n  textmsg('main')\nend\n")
    assert bench.log == ["main"]


POINT_FILES = {"path.txt": b"1 2 3 4 5 6\n", "parts/path.txt": b"6 5 4 3 2 1\n"}


class TestTaskFiles:
    LOAD = "def a():\n  textmsg(load_micro_line_file({}, 4))\n  textmsg(get_micro_line_values_by_index(0, 0, 1))\nend\n"

    @pytest.mark.parametrize(
        ("name", "first"), [("path.txt", 1.0), ("/task/path.txt", 1.0), ("parts/path.txt", 6.0), ("./path.txt", 1.0)]
    )
    def test_a_command_reads_a_file_of_the_task_folder(self, name, first):
        bench = run(self.LOAD.format(repr(name)), world=MemoryEnvironment(POINT_FILES))
        assert bench.alarms == []
        assert bench.log[0] == "0"
        assert bench.log[1].startswith(f"[{first}, ")

    @pytest.mark.parametrize(
        ("name", "code", "message", "hint"),
        [
            ("path", "R104", "the file 'path' does not exist", "the task folder holds path.txt"),
            ("none.txt", "R104", "the file 'none.txt' does not exist", None),
            ("parts", "R104", "the file 'parts' is a folder", None),
            ("", "R104", "the file '' is a folder", None),
            ("../path.txt", "R123", "outside", None),
            ("/etc/passwd", "R123", "outside", None),
        ],
    )
    def test_what_it_cannot_read_is_an_alarm_on_its_line(self, name, code, message, hint):
        (alarm,) = run(self.LOAD.format(repr(name)), world=MemoryEnvironment(POINT_FILES)).alarms
        assert (alarm.code, alarm.line, alarm.details["command"]) == (code, 2, "load_micro_line_file")
        if code == "R104":
            assert message in alarm.text
            assert alarm.details.get("hint") == hint

    def test_a_run_without_a_task_folder_says_so(self):
        (alarm,) = run(self.LOAD.format("'path.txt'")).alarms
        assert alarm.line == 2

    def test_a_file_that_is_too_large_is_not_read(self, monkeypatch):
        monkeypatch.setattr("elitescript.commands.micro_file.BYTES_MAX", 11)
        (alarm,) = run(self.LOAD.format("'path.txt'"), world=MemoryEnvironment(POINT_FILES)).alarms
        assert "has 12 bytes; at most 11 are allowed" in alarm.text
        assert alarm.details["unit"] == "bytes"

    def test_what_the_system_cannot_read_is_told_in_its_words(self, monkeypatch):
        def broken(self, name, mode, encoding, newline):
            raise OSError(5, "Input/output error", name)

        monkeypatch.setattr("elitescript.environment.memory.MemoryFiles.open", broken)
        (alarm,) = run(self.LOAD.format("'path.txt'"), world=MemoryEnvironment(POINT_FILES)).alarms
        assert "the file 'path.txt' cannot be read: Input/output error" in alarm.text

    def test_indices_end_with_the_program(self):
        bench = Bench(world=MemoryEnvironment(POINT_FILES))
        for _ in range(2):
            bench.start(self.LOAD.format("'path.txt'")).run()
        assert [text for text in bench.log if len(text) == 1] == ["0", "0"]
