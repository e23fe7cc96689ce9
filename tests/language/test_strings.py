from __future__ import annotations

import pytest

from elitescript.language.text.strings import formatted_end, prefix_start, string_end_pattern


@pytest.mark.parametrize(
    ("quote", "text", "end"),
    [
        ("'", "abc' x", 4),
        ("'", "a\\'b'", 5),
        ("'", "a\\\\' '", 4),
        ("'", "a\nb'", None),
        ("'", "a\\\nb'", 5),
        ('"', "a'b\"", 4),
        ("'''", "a'b''c'''", 9),
        ("'''", "a\nb'''", 6),
        ("'''", "a\\'''b", None),
    ],
)
def test_where_a_string_ends(quote, text, end):
    found = string_end_pattern(quote).match(text)
    assert (found.end() if found else None) == end


@pytest.mark.parametrize(
    ("text", "start"),
    [("x = rb'", 4), ("x = 'a", 4), ("x = Fr'", 4), ("bar'", 3), ("x = _b'", 6), ("f'", 0), ("1f'", 2)],
)
def test_where_a_prefix_starts(text, start):
    assert prefix_start(text, text.index("'")) == start


@pytest.mark.parametrize(
    ("text", "end"),
    [
        ("{a['k']}' x", 9),
        ("{{'", 3),
        ("{x:>{w}}'", 9),
        ("{x!r}'", 6),
        ("{f'{y}'}'", 9),
        ("{'}'}'", 6),
        ("{x", -1),
        ("{'", -1),
        ("{x\n}'", -1),
        ("{f'" * 20, -1),
    ],
)
def test_where_a_formatted_string_ends(text, end):
    assert formatted_end(text, 0, "'") == end
