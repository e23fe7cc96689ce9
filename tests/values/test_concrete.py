"""Expressions that are computed without an effect: their values, what they refuse, and what they never run."""

import ast

import pytest

from elitescript.errors import DebugError
from elitescript.values.concrete import GLANCE_SIZE_MAX, UNKNOWN, MissingName, builtin_call, computed, glance


class Own:
    """An object of a program's class: every operation with it is counted."""

    def __init__(self):
        self.state = 2
        self.ran = []

    def __getattr__(self, name):
        self.ran.append(name)
        return 7

    def __hash__(self):
        return hash("a")

    @property
    def level(self):
        self.ran.append("level")

    def operated(self, *_):
        self.ran.append("an operator")
        return 1

    __eq__ = __lt__ = __add__ = __radd__ = __neg__ = __len__ = __bool__ = __getitem__ = __contains__ = operated
    __index__ = __int__ = __call__ = __iter__ = __format__ = __str__ = operated


def names(own):
    return {"own": own, "mixed": [own, 1], "keyed": {own: 2, "k": 1}, "q": [3, 5], "i": 1, "text": "go ", "n": None}


def full(text, held):
    def value(name):
        if name not in held:
            raise MissingName(name, lambda: held)
        return held[name]

    return computed(ast.parse(text, mode="eval").body, value, builtin_call)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("q[i] + 1", 6),
        ("-q[-1] // 2", -3),
        ("own.state", 2),
        ("mixed[1]", 1),
        ('keyed["k"]', 1),
        ("n is None and len(text) == 3", True),
        ('text.strip() == "go"', True),
        ("max(q) if i else n", 5),
        ("[e * 2 for e in q]", [6, 10]),
        ("f'{q[0]:03d}'", "003"),
        ("2 ** 70", 2**70),
        ("'%03d of 100 %% * %s' % (i, text)", "001 of 100 % * go "),
    ],
)
def test_a_value(text, value):
    own = Own()
    own.ran.clear()
    assert full(text, names(own)) == glance(ast.parse(text, mode="eval").body, names(own)) == value
    assert not own.ran


@pytest.mark.parametrize(
    "text",
    [
        *("own + 1", "1 + own", "-own", "not own", "own == 1", "1 in own", "None in own", "own in q", "'a' in mixed"),
        *("own[0]", "q[own]", "own()", "own.level", "own.other", "len(own)", "str(own)", "f'{own}'", "int(own)"),
        *("[e for e in own]", "sorted(mixed)", 'keyed["a"]', "max(own, 1)", "own and 1", "1 if own else 2", "{own: 1}"),
        *("mixed == q", "q.append(1)", "q.sort()", "(x := 1)", "(lambda: 1)()", "missing", "missing()", "hash(own)"),
    ],
)
def test_what_could_run_the_program_is_refused(text):
    own = Own()
    held = names(own)
    before = repr(held["q"])
    with pytest.raises(DebugError):
        full(text, held)
    assert glance(ast.parse(text, mode="eval").body, held) is UNKNOWN
    assert not own.ran
    assert repr(held["q"]) == before


@pytest.mark.parametrize(
    "text",
    [
        "sum(big)",
        "big + [1]",
        "1.5 in big",
        "[e for e in big]",
        "'a' * 10 ** 9",
        "9 ** 9 ** 9",
        "'%99999999d' % 1",
        "b'%*d' % (10 ** 9, 1)",
    ],
)
def test_a_glance_is_short(text):
    assert glance(ast.parse(text, mode="eval").body, {"big": [0.0] * (GLANCE_SIZE_MAX + 1)}) is UNKNOWN


def test_a_glance_at_a_long_list_sees_its_elements_and_its_length():
    big = {"big": list(range(1_000_000))}
    assert glance(ast.parse("big[5] + len(big)", mode="eval").body, big) == 1_000_005


def test_a_name_of_the_program_hides_a_function():
    tree = ast.parse("len(q)", mode="eval").body
    assert glance(tree, {"q": [1], "len": lambda q: 9}) is UNKNOWN
    assert glance(None, {}) is UNKNOWN
    assert glance(ast.parse("q = 1").body[0], {}) is UNKNOWN
