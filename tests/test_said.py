"""Texts that keep their template and values."""

from __future__ import annotations

import copy
import json
import pickle

import pytest

from elitescript.said import Said, escaped, joined, parts_of, rebuilt, said, template_of, values_of

LIMIT = said("{command}: {value:.2f} rad is more than {limit:g}", command="movej", value=3.14159, limit=3.0)


class TestSaid:
    def test_it_is_its_text(self):
        assert LIMIT == "movej: 3.14 rad is more than 3"
        assert {LIMIT: 1}["movej: 3.14 rad is more than 3"] == 1
        assert isinstance(LIMIT, str)
        assert json.dumps(LIMIT) == '"movej: 3.14 rad is more than 3"'

    def test_the_template_has_names_alone_in_its_holes(self):
        assert LIMIT.template == "{command}: {value} rad is more than {limit}"

    def test_the_values_are_what_stands_in_the_holes(self):
        assert LIMIT.values == {"command": "movej", "value": "3.14", "limit": "3"}

    @pytest.mark.parametrize(
        ("value", "shown"),
        [
            (7, 7),
            (2**53 - 1, 2**53 - 1),
            (-(2**53), "-9007199254740992"),
            (5.0, "5.0"),
            (True, "True"),
            (None, "None"),
            ([1], "[1]"),
            ("x{y}", "x{y}"),
        ],
    )
    def test_a_value_is_a_whole_number_or_the_text_that_is_shown(self, value, shown):
        text = said("<{value}>", value=value)
        assert text == f"<{value}>"
        assert text.values == {"value": shown}
        assert type(text.values["value"]) is type(shown)

    @pytest.mark.parametrize(
        ("template", "text"),
        [
            ("{x!r:>5}", "  'a'"),
            ("{x!s}", "a"),
            ("{x:>3}", "  a"),
            ("{{x}} {x}", "{x} a"),
            ("{x}{x}", "aa"),
            ("no holes", "no holes"),
        ],
    )
    def test_templates_and_values_make_the_text(self, template, text):
        made = said(template, x="a")
        assert made == text
        assert made.template.format(**made.values) == text

    @pytest.mark.parametrize("template", ["{x", "x}", "{}", "{0}", "{x.y}", "{x[0]}", "{x:{y}}", "{x} {x!r}"])
    def test_other_braces_are_refused(self, template):
        with pytest.raises(ValueError, match="template"):
            said(template, x="a", y="b")

    def test_a_hole_without_value_is_refused(self):
        with pytest.raises(KeyError, match="y"):
            said("{x} {y}", x=1)

    @pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda text: pickle.loads(pickle.dumps(text))])
    def test_copies_keep_the_template(self, again):
        outer = again(said("{text}; no more", text=LIMIT))
        assert outer == "movej: 3.14 rad is more than 3; no more"
        assert outer.values["text"].template == LIMIT.template

    def test_what_is_made_of_it_is_a_plain_text(self):
        for text in (LIMIT + ".", LIMIT[:5], LIMIT.strip(), f"{LIMIT}", str(LIMIT), " ".join([LIMIT])):
            assert type(text) is str

    def test_nothing_in_it_can_be_changed(self):
        with pytest.raises(AttributeError):
            LIMIT._parts = ("", ())
        with pytest.raises(AttributeError):
            del LIMIT._parts
        LIMIT.values["limit"] = "4"
        assert LIMIT.values["limit"] == "3"

    def test_one_of_a_constant_has_no_values(self):
        assert Said("{x}").template == "{{x}}"
        assert Said("{x}").values == {}


class TestJoined:
    def test_parts_keep_their_templates(self):
        both = joined("; ", [LIMIT, "stop"])
        assert both == "movej: 3.14 rad is more than 3; stop"
        assert both.template == "{part_1}; {part_2}"
        assert both.values["part_1"].template == LIMIT.template

    def test_one_is_itself(self):
        assert joined("; ", [LIMIT]) is LIMIT

    def test_none_is_an_empty_text(self):
        assert joined("; ", []) == ""


class TestJson:
    def test_a_text_within_a_text_is_an_object(self):
        inner = {"text": str(LIMIT), "template": LIMIT.template, "values": LIMIT.values}
        assert parts_of(said("{why}, {n} times", why=LIMIT, n=3), "hint_") == {
            "hint_template": "{why}, {n} times",
            "hint_values": {"why": inner, "n": 3},
        }

    def test_a_constant_is_its_own_template(self):
        assert template_of("a {b}") == escaped("a {b}") == "a {{b}}"
        assert values_of("a {b}") == {}


class TestRebuilt:
    def test_parts_make_the_text_again(self):
        again = rebuilt(str(LIMIT), LIMIT.template, LIMIT.values)
        assert again == LIMIT
        assert (again.template, again.values) == (LIMIT.template, LIMIT.values)

    @pytest.mark.parametrize(
        ("text", "template", "values"),
        [
            ("a", "{x}", {}),
            ("a", "{x}", {"x": "b"}),
            ("a", "a", {"x": "b"}),
            ("a", "{x!r}", {"x": "a"}),
            ("a", "{x.__class__}", {"x": "a"}),
            ("a", "{", {}),
        ],
    )
    def test_parts_that_do_not_make_it_are_refused(self, text, template, values):
        with pytest.raises(ValueError, match="template"):
            rebuilt(text, template, values)
