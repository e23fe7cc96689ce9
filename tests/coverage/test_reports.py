"""The reports of coverage against texts written by hand."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from xml.etree.ElementTree import Element

import pytest

from elitescript.coverage.cobertura import cobertura
from elitescript.coverage.html_pages import INDEX, html_pages
from elitescript.coverage.json_report import json_report
from elitescript.coverage.lcov import lcov
from elitescript.coverage.model import Branch, Function, Handler, ProgramCoverage, percent_text, total
from elitescript.coverage.terminal import missing_text, table, unmet_lines
from elitescript.coverage.unmet import Refusal, Unmet, UnmetFault, UnmetHandler

CELL = ProgramCoverage(
    "jobs/cell & co.script",
    ("def cell():", "  if a < 1:", "    b()", "  end", "  while c():", "    d()", "    e()", "  end", "end"),
    {2: 7, 3: 0, 5: 7, 6: 0, 7: 0},
    (Branch(2, 3, 0), Branch(2, None, 7), Branch(5, 6, None), Branch(5, None, None)),
    (Function("open", 2, 3, 7), Function("shut", 5, 6, 0), Function("open", 7, 8, 1)),
    (Handler(6, "except ValueError", 0),),
)
WHOLE = ProgramCoverage("whole.script", ("sleep(1)",), {1: 3})
NOTHING = ProgramCoverage("nothing.script", ())


class TestNumbers:
    def test_lines_and_branches_count_together(self):
        numbers = CELL.numbers
        assert (numbers.lines, numbers.lines_hit, numbers.branches, numbers.branches_hit) == (5, 2, 4, 1)
        assert (numbers.functions, numbers.functions_hit) == (3, 2)
        assert numbers.percent == pytest.approx(100 * 3 / 9)
        assert total([CELL, WHOLE]).percent == 40.0
        assert NOTHING.numbers.percent == 100.0

    def test_nothing_and_everything_are_not_rounded(self):
        assert [percent_text(value) for value in (0, 0.2, 33.4, 99.9, 100)] == ["0%", "1%", "33%", "99%", "100%"]


class TestLcov:
    def test_the_tracefile_has_true_counts(self):
        assert lcov([CELL, WHOLE]) == (
            "TN:\nSF:jobs/cell & co.script\n"
            "FN:2,open\nFN:5,shut\nFN:7,open@7\nFNDA:7,open\nFNDA:0,shut\nFNDA:1,open@7\nFNF:3\nFNH:2\n"
            "BRDA:2,0,0,0\nBRDA:2,0,1,7\nBRDA:5,0,0,-\nBRDA:5,0,1,-\nBRF:4\nBRH:1\n"
            "DA:2,7\nDA:3,0\nDA:5,7\nDA:6,0\nDA:7,0\nLF:5\nLH:2\nend_of_record\n"
            "TN:\nSF:whole.script\nFNF:0\nFNH:0\nBRF:0\nBRH:0\nDA:1,3\nLF:1\nLH:1\nend_of_record\n"
        )

    def test_a_name_stays_in_its_line(self):
        assert "SF:a\\nb.script\n" in lcov([ProgramCoverage("a\nb.script", ())])


# Of coverage-04.dtd: the elements in each element, and the attributes that it must have.
DTD = {
    "coverage": (
        ("sources", "packages"),
        "line-rate branch-rate lines-covered lines-valid branches-covered branches-valid complexity version timestamp",
    ),
    "sources": (("source",), ""),
    "source": ((), ""),
    "packages": (("package",), ""),
    "package": (("classes",), "name line-rate branch-rate complexity"),
    "classes": (("class",), ""),
    "class": (("methods", "lines"), "name filename line-rate branch-rate complexity"),
    "methods": (("method",), ""),
    "lines": (("line",), ""),
    "line": (("conditions",), "number hits"),
}
OPTIONAL = {"line": {"branch", "condition-coverage", "missing-branches"}}
"""Of coverage.py besides: `missing-branches`."""


def check_against_dtd(element: Element) -> None:
    children, attributes = DTD[element.tag]
    tags = [child.tag for child in element]
    assert tags == sorted(tags, key=children.index), element.tag
    if element.tag in ("coverage", "class"):
        assert tags == list(children)
    assert set(attributes.split()) <= set(element.attrib) <= set(attributes.split()) | OPTIONAL.get(element.tag, set())
    for child in element:
        check_against_dtd(child)


class TestCobertura:
    def document(self, *programs: ProgramCoverage) -> Element:
        text = cobertura(programs, root="/home/a<b", version="1.2", time_ms=1700000000000)
        return ElementTree.fromstring(text)

    def test_it_follows_the_document_type(self):
        check_against_dtd(self.document(CELL, WHOLE, NOTHING))

    def test_a_folder_is_a_package_and_a_program_a_class(self):
        root = self.document(CELL, WHOLE)
        assert root.findtext("sources/source") == "/home/a<b"
        assert (root.attrib["lines-valid"], root.attrib["lines-covered"]) == ("6", "3")
        assert [package.attrib["name"] for package in root.iter("package")] == [".", "jobs"]
        found = root.find("packages/package[@name='jobs']/classes/class")
        assert found is not None
        assert found.attrib["filename"] == "jobs/cell & co.script"
        assert (found.attrib["line-rate"], found.attrib["branch-rate"]) == ("0.4", "0.25")
        lines = {line.attrib["number"]: line.attrib for line in found.iter("line")}
        assert lines["2"] == {
            "number": "2",
            "hits": "7",
            "branch": "true",
            "condition-coverage": "50% (1/2)",
            "missing-branches": "3",
        }
        assert lines["5"]["condition-coverage"] == "0% (0/2)"
        assert lines["5"]["missing-branches"] == "6,exit"
        assert lines["3"] == {"number": "3", "hits": "0"}


class TestTerminal:
    def test_the_table(self):
        assert table([CELL, WHOLE], shows_missing=True) == [
            "Program                 Lines   Missed   Branches   Missed   Functions   Cover   Missing",
            "-" * 88,
            "jobs/cell & co.script       5        3          4        3         2/3     33%   2->3, 3, 6-7",
            "whole.script                1        0          0        0         0/0    100%",
            "-" * 88,
            "TOTAL                       6        3          4        3         2/3     40%",
        ]
        assert "Missing" not in table([CELL])[0]
        assert table([]) == []

    def test_lines_that_ran_part_spans_of_those_that_did_not(self):
        program = ProgramCoverage("a", (), {1: 0, 3: 0, 4: 1, 9: 0})
        assert missing_text(program) == "1-3, 9"


UNMET = Unmet(
    refusals=(Refusal("a.script", 4, "movej", "MotionError", "the target is outside"),),
    handlers=(UnmetHandler("a.script", 9, "except ValueError"),),
    safety_states=("REDUCED", "FAULT"),
    faults=(UnmetFault("camera (5000)", ("refuse", "silence")),),
    alarms=("R110",),
)


class TestUnmet:
    def test_only_what_there_is_has_a_title(self):
        assert unmet_lines(UNMET) == [
            "refusals of commands:",
            "  a.script:4: movej: MotionError: the target is outside",
            "except paths:",
            "  a.script:9: except ValueError",
            "safety states:",
            "  REDUCED, FAULT",
            "faults of the world:",
            "  camera (5000): refuse, silence",
        ]
        assert unmet_lines(Unmet()) == []

    def test_json_holds_everything(self):
        found = json.loads(json_report([CELL], UNMET))
        (program,) = found["programs"]
        assert program["file"] == "jobs/cell & co.script"
        assert program["lines"] == {"2": 7, "3": 0, "5": 7, "6": 0, "7": 0}
        assert program["branches"][2] == {"line": 5, "to": 6, "hits": None}
        assert program["functions"][1] == {"name": "shut", "line": 5, "end_line": 6, "hits": 0}
        assert program["handlers"] == [{"line": 6, "text": "except ValueError", "hits": 0}]
        assert found["totals"]["percent"] == 33.33
        assert found["met"] == {"alarms": ["R110"]}
        assert found["unmet"]["faults"] == [{"on": "camera (5000)", "kinds": ["refuse", "silence"]}]
        assert found["unmet"]["refusals"][0]["command"] == "movej"


class TestHtml:
    def test_each_program_has_a_page_and_texts_are_escaped(self):
        evil = ProgramCoverage("a<b>.script", ('textmsg("<script>")',), {1: 1})
        pages = html_pages([CELL, evil], UNMET)
        assert list(pages) == [INDEX, "jobs-cell-co.script.html", "a-b-.script.html"]
        assert "textmsg(&quot;&lt;script&gt;&quot;)" in pages["a-b-.script.html"]
        for text in pages.values():
            assert "<script" not in text
            assert "http" not in text
        assert 'href="jobs-cell-co.script.html"' in pages[INDEX]
        assert "camera (5000): refuse, silence" in pages[INDEX]

    def test_lines_are_marked(self):
        text = html_pages([CELL], Unmet())["jobs-cell-co.script.html"]
        assert (
            '<tr id="L2" class="part"><td class="number">2</td><td class="hits" title="2-&gt;3: 0; 2-&gt;exit: 7">7'
            in text
        )
        assert '<tr id="L3" class="miss">' in text
        assert '<tr id="L4" class="">' in text
        assert "never taken: 2-&gt;3" in text

    def test_no_two_pages_are_alike_on_a_disk_without_case(self):
        programs = [ProgramCoverage(path, ()) for path in ("a/b.script", "a-b.script", "A-B.script", "index")]
        names = [name.lower() for name in html_pages(programs, Unmet())]
        assert len(names) == len(set(names)) == 5
