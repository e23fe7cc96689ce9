from elitescript.controller.views.warning_limit import WarningLimit
from elitescript.messages.events import DeviceNoted, TextMessage, Warned


def warned(number, **fields):
    return Warned(number, f"r = 0.{number} m is shortened", "main", number, **fields)


def test_ten_of_a_kind_pass_and_the_others_are_counted():
    limit = WarningLimit()
    assert [limit.takes(warned(number)) for number in range(1389)].count(True) == 10
    (rest,) = limit.rest(7)
    assert (rest.tick, rest.line, rest.thread) == (7, 10, "main")
    assert rest.text == "… 1,379 more of this kind, beginning with: r = 0.10 m is shortened"


def test_each_kind_counts_by_itself():
    limit = WarningLimit()
    for number in range(12):
        limit.takes(warned(number))
        limit.takes(warned(number, code="W250"))
        limit.takes(Warned(number, "something else"))
        limit.takes(DeviceNoted(number, "camera", "lost", is_warning=True))
    assert [event.text[:8] for event in limit.rest(0)] == ["… 2 more"] * 4


def test_of_one_code_all_texts_are_one_kind():
    limit = WarningLimit()
    assert [limit.takes(Warned(0, text, code="W250")) for text in "abcdefghijkl"].count(True) == 10


def test_what_is_no_warning_always_passes():
    limit = WarningLimit()
    note, text = DeviceNoted(0, "camera", "sent"), TextMessage(0, "x", "main", 1)
    assert all(limit.takes(event) for _ in range(50) for event in (note, text))
    assert limit.rest(0) == []


def test_the_next_run_begins_with_none():
    limit = WarningLimit()
    for number in range(12):
        limit.takes(warned(number))
    limit.rest(0)
    assert limit.takes(warned(1))
    assert limit.rest(0) == []
