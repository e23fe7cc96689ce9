"""The form of specification pages, and the comparison of outcomes."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from tests.specification.pages import CaseOutcome, differences, parse_page

PAGE = """\
# Title

Prose.

## Part

### Case `one`

```elite crlf at=0.5
def job():
  textmsg("# no heading")
end
```
```expect
out: # no heading
warn: W201 line 2
```
```expect strict firmware=2.10
error: E001 line 2
```

### Case two

```python
ignored = True
```
```elite needs=modbus
x
```
```expect
no findings
```
"""


def page(expect: str, elite: str = "x") -> str:
    return f"# T\n```elite\n{elite}\n```\n```expect\n{expect}\n```\n"


def expectation(expect: str):
    return parse_page(page(expect))[0].expectations[0]


def outcome(**changes) -> CaseOutcome:
    made = CaseOutcome(state=changes.pop("state", "finished"))
    for name, value in changes.items():
        if name in made.lists:
            made.lists[name] = value
        else:
            setattr(made, name, value)
    return made


class TestPages:
    def test_a_case_is_what_stands_under_a_heading(self):
        cases = parse_page(PAGE)
        assert [case.title for case in cases] == ["Part/Case one", "Part/Case two"]
        assert [len(case.expectations) for case in cases] == [2, 1]

    def test_words_apply_to_the_text(self):
        text = parse_page(PAGE)[0].texts[0]
        assert text.words == {"crlf": "crlf", "at": "0.5"}
        assert text.sent == 'def job():\r\n  textmsg("# no heading")\r\nend\r\n'

    def test_a_case_tells_what_it_needs(self):
        assert [case.needs for case in parse_page(PAGE)] == ["", "modbus"]

    def test_facts_keep_their_line_in_the_page(self):
        facts = parse_page(PAGE)[0].expectations[0].facts
        assert [(fact.line, fact.key, fact.value) for fact in facts] == [
            (15, "out", "# no heading"),
            (16, "warn", "W201 line 2"),
        ]

    def test_an_expectation_is_named_by_its_conditions(self):
        assert [e.label for e in parse_page(PAGE)[0].expectations] == ["", "strict firmware=2.10"]

    def test_cell_and_inputs_belong_to_their_case(self):
        world = "```cell\n[contact]\n```\n```inputs\n0.5: flag[1] = 1\n1: external_wrench[0] = -2.5\n```\n"
        case, other = parse_page(page("") + world + page("").replace("# T", "# U"))
        assert case.world == "[contact]\n"
        assert case.inputs == ((0.5, "flag[1]", 1.0), (1.0, "external_wrench[0]", -2.5))
        assert (other.world, other.inputs) == ("", ())

    @pytest.mark.parametrize(
        ("text", "place"),
        [
            ("# T\n```inputs\n0.5 flag = 1\n```\n", "line 3"),
            ("# T\n```elite\nx\n", "line 2"),
            ("# T\n```elite\nx\n```\n", "line 3"),
            ("# T\n```expect\n```\n", "line 2"),
            ("# T\n```elite wrong\n```\n```expect\n```\n", "line 2"),
            (page("what: 1"), "line 6"),
            (page("out"), "line 6"),
            ("# T\n```elite\n```\n```elite\n```\n```expect\n```\n", "line 5"),
        ],
    )
    def test_a_mistake_in_a_page_is_located(self, text, place):
        with pytest.raises(UsageError, match=place):
            parse_page(text)


class TestComparison:
    @pytest.mark.parametrize(
        ("expect", "changes"),
        [
            ("", {}),
            ("out: a\nout: b", {"out": ["a", "b"]}),
            ("print:", {"print": [""]}),
            ("alarm: NameError line 3", {"alarm": ["R100 NameError line 3"], "state": "alarm"}),
            ("alarm: R100 line 3", {"alarm": ["R100 NameError line 3"], "state": "alarm"}),
            ("alarm: NameError", {"alarm": ["R100 NameError line 3"], "state": "alarm"}),
            ("state: stuck", {"state": "stuck"}),
            ("time: 0.1", {"time_s": 0.1}),
            ("time: 0.1 to 0.2", {"time_s": 0.2}),
            ("time: at least 2", {"time_s": 5.0}),
            ("global: n = 3", {"global": ["n = 3"]}),
            ("no globals", {}),
            ("moves: 0", {}),
            ("log-warning: [SEC] ", {"log_warnings": ["[SEC] Exception: x"]}),
            ("warn: W201 line 2", {"findings": ["warn: W201 line 2", "warn: W207 line 9"]}),
            ("node: 1 a b", {"node": "1 a b"}),
        ],
    )
    def test_holds(self, expect, changes):
        assert differences(outcome(**changes), expectation(expect)) == []

    @pytest.mark.parametrize(
        ("expect", "changes"),
        [
            ("", {"out": ["a"]}),
            ("out: a", {}),
            ("out: a\nout: b", {"out": ["b", "a"]}),
            ("", {"state": "alarm"}),
            ("", {"error": ["E001 line 1"], "state": ""}),
            ("alarm: NameError line 3", {"alarm": ["R100 NameError line 4"], "state": "alarm"}),
            ("alarm: TypeError line 3", {"alarm": ["R100 NameError line 3"], "state": "alarm"}),
            ("state: stopped", {}),
            ("time: 0.1", {"time_s": 0.104}),
            ("time: at least 2", {"time_s": 1.9}),
            ("global: n = 3", {"global": ["n = 3", "m = 1"]}),
            ("no globals", {"global": ["n = 3"]}),
            ("moves: 0", {"moves": 1}),
            ("log-warning: [SEC] ", {}),
            ("no log-warnings", {"log_warnings": ["x"]}),
            ("warn: W201 line 2", {"findings": ["finding: W201 line 2"]}),
            ("no findings", {"findings": ["warn: W201 line 2"]}),
            ("signal: flag[0] = True", {}),
            ("node: 1 a", {"node": "2 a"}),
            ("refused: NameError", {}),
        ],
    )
    def test_does_not_hold(self, expect, changes):
        assert differences(outcome(**changes), expectation(expect)) != []


class TestConversations:
    PAGE = """# Page

### Talk

```elite query
> req 1 2 + 2
< {reply}
```
```expect
state: running
```
"""

    def differences(self, reply):
        from tests.specification.running import run_case

        (case,) = parse_page(self.PAGE.replace("{reply}", reply))
        return run_case(case, case.expectations[0])

    def test_what_is_heard_is_compared(self):
        assert self.differences("[1] [success] : [4]") == []
        assert self.differences("[1] [success] : [...]") == []
        assert self.differences("[1] [success] : [5]") == [
            "received '[1] [success] : [4]', expected '[1] [success] : [5]'"
        ]

    def test_what_nobody_says_is_missed_and_what_nobody_expects_is_told(self):
        assert self.differences("[1] [success] : [4]\n< more") == ["received '', expected 'more'"]
        assert self.differences("[1] [success] : [4]\n> req 2 5") == ["received '[2] [success] : [5]\\n' besides"]
