"""What is no property or measure is refused with its place."""

from random import Random

import pytest

from elitescript import VirtualRobot
from elitescript.errors import UsageError
from elitescript.properties.checks import Checks
from elitescript.properties.parsing import parse_measure, parse_property

REFUSED = (
    ("always(tcp_sped < 1)", "column 8", "did you mean 'tcp_speed'?"),
    ("alway(tcp[2] > 1)", "column 1", "did you mean 'always'?"),
    ("tcp[2] > 1", "column 1", "inside functions over time alone"),
    ("time_s < 3 and q[0] > 1", "column 16", "inside functions over time alone"),
    ("always(joints[0] > 1)", "column 8", "write q"),
    ("always(globals['a'] > 1)", "column 8", "known at the end of the run"),
    ("always(tcp[6] > 1)", "column 12", "indices 0 to 5"),
    ("always(tcp['z'] > 1)", "column 12", "indices 0 to 5"),
    ("always(q[0] > tcp[0])", "column 8", "rad and m are different units"),
    ("max_of(tcp[0] + t) > 1", "column 8", "m and s are different units"),
    ("degrees(time_s) > 1", "column 9", "degrees takes rad"),
    ("globals['cuont'] > 1", "column 9", "did you mean 'count'?"),
    ("globals[count] > 1", "column 9", "as a number, or a name as a text"),
    ("signals['standard_digital_ot[0]']", "column 9", "did you mean 'standard_digital_out'?"),
    ("eventually(signal('standard_digital_out[16]'))", "column 19", "indices 0 to 15"),
    ("eventually(signal('standard_digital_out'))", "column 19", "needs an index"),
    ("eventually(standard_digital_out[16])", "column 12", "indices 0 to 15"),
    ("eventually(standard_digital_out)", "column 12", "needs an index"),
    ("standard_digital_out[-1]", "column 1", "write the index as a number in brackets"),
    ("eventually(standard_digital_out[line])", "column 12", "write the index as a number in brackets"),
    ("flag[128]", "column 1", "indices 0 to"),
    ("always(tcp.w > 0)", "column 8", "tcp has x, y, z, rx, ry, rz"),
    ("joints.elbo > 0", "column 1", "joints has base, shoulder, elbow"),
    ("tcp.z > 0", "column 1", "inside functions over time alone"),
    ("eventually(signal(state))", "column 19", "as a text"),
    ("signal('flag[0]')", "column 1", 'signals["..."]'),
    ("alarms[0].code == 'R101'", "column 1", 'alarms[0]["code"]'),
    ("alarms[0]['cod'] == 'R101'", "column 11", "did you mean 'code'?"),
    ("alarms['code'] == 'R101'", "column 8", "write the index as a number"),
    ("time_s < 3 && state == 'finished'", "column 12", "write `and` instead of `&&`"),
    ("time_s = 3", "column 8", "write `==` instead of `=`"),
    ("good = 3", "column 6", 'write globals["good"] == ...'),
    ("good == 3", "column 1", 'a global of the program is globals["good"]'),
    ("count == 3", "column 1", 'write globals["count"]'),
    ("globals.good == 3", "column 1", 'write globals["good"]'),
    ("global.good == 3", "column 1", 'write globals["good"]'),
    ("run.globals['a'] == 3", "column 1", "without `run.`"),
    ("warnings == 0", "column 1", "write findings.warning"),
    ("0 < len(log) and log == 0", "column 18", "write len(log)"),
    ("findings == 0", "column 1", "findings.error, findings.warning or findings.note"),
    ("errors == 0", "column 1", "write findings.error"),
    ("state == 'Finished'", "column 10", "did you mean 'finished'?"),
    ("state == finished", "column 10", 'write "finished"'),
    ("state == 'done'", "column 10", "there are finished, stopped"),
    ("time_s < 3 and true", "column 16", "write True"),
    ("get_standard_digital_out(0)", "column 1", 'write signals["standard_digital_out[0]"]'),
    ("signals.standard_digital_out == 1", "column 1", 'write signals["standard_digital_out[0]"]'),
    ("state > 3", "column 1", "neither smaller nor larger"),
    ("state == 3", "column 1", "never equal"),
    ("state", "column 1", "this is a text, not true or false"),
    ("time_s", "column 1", "this is a number, not true or false"),
    ("not time_s", "column 5", "this is a number, not true or false"),
    ("state + 1 > 2", "column 1", "this is a text, not a number"),
    ("(time_s > 1) + 1 > 2", "column 2", "true or false, not a number"),
    ("always(always(t > 1))", "column 8", "inside another function over time"),
    ("before(t > 1)", "column 1", "before takes 2 arguments, not 1"),
    ("max_of(t > 1) > 1", "column 8", "takes what is a number"),
    ("always(t)", "column 8", "takes what is true or false"),
    ("always", "column 1", "call it"),
    ("time_s() > 1", "column 1", "cannot be called"),
    ("print('x')", "column 1", "there is no function 'print'"),
    ("''.join([]) == ''", "column 1", "functions by their names"),
    ("(lambda: True)()", "column 2", "functions by their names"),
    ("lambda: True", "column 1", "lambda is not possible"),
    ("(x := True)", "column 2", ":= is not possible"),
    ("[x for x in log] == []", "column 1", "a comprehension is not possible"),
    ("all(x for x in log)", "column 1", "there is no function 'all'"),
    ("f'{time_s}' == ''", "column 1", "an f-string is not possible"),
    ("log[0:1] == []", "column 5", "as a number"),
    ("abs(*joints) > 1", "column 5", "* is not possible"),
    ("round(time_s, digits=2) > 1", "column 22", "no arguments by name"),
    ("round(time_s, 400) > 1", "column 15", "0 to 15 digits"),
    ("2 ** 9 ** 9 > 1", "column 6", "an exponent is a literal"),
    ("time_s << 3 > 1", "column 1", "this operator is not possible"),
    ("~len(log) > 1", "column 1", "~ is not possible"),
    ("1j > 0", "column 1", "neither a number nor a text"),
    ("b'x' == 1", "column 1", "neither a number nor a text"),
    ("1e999 > 1", "column 1", "too large"),
    ("state is 'finished'", "column 1", "write == or !="),
    ("3 in state", "column 1", "cannot be in a text"),
    ("'a' in time_s", "column 8", "holds nothing"),
    ("min(state) > 1", "column 5", "this is a text"),
    ("max_of(max(tcp)) > 1", "column 8", "m and rad are different units"),
    ("len(time_s) > 1", "column 5", "no length"),
    ("1 +", "column 1", "invalid syntax"),
    ("time_s < 3; state", "column 11", "invalid syntax"),
    ("é + tim_s > 1", "column 1", "nothing is called 'é'"),
    ("'é' == stat", "column 8", "did you mean 'state'?"),
    ("time_s < 3 and\n tim_s > 1", "column 17", "did you mean 'time_s'?"),
    ("-" * 60 + "1 > 0", "column 40", "more than 40 deep"),
    ("(" * 500 + "1" + ")" * 500, "column", "too many nested"),
    ("1 > 0 " * 1000, "2000 characters", "at most"),
    ("x" * 1_000_000, "2000 characters", "at most"),
    ("a\0b", "column 2", "no character"),
    ("\ud800 > 1", "column 1", "no character"),
    ("", "write an expression", "''"),
    (" \n ", "write an expression", "''"),
)


@pytest.mark.parametrize(("text", "place", "words"), REFUSED, ids=[text[:40] for text, _, _ in REFUSED])
def test_what_is_no_property_is_refused_with_its_place(text, place, words):
    with pytest.raises(UsageError) as caught:
        parse_property(text, ["count"])
    assert place in str(caught.value)
    assert words in str(caught.value)


def test_a_caret_stands_below_what_is_wrong():
    with pytest.raises(UsageError) as caught:
        parse_property("'é' == 'é' and always(tcp_sped < 1)")
    _, line, caret = str(caught.value).splitlines()
    assert line[caret.index("^") : caret.rindex("^") + 1] == "tcp_sped"


def test_a_caret_stands_below_what_is_wrong_in_a_long_line():
    with pytest.raises(UsageError) as caught:
        parse_property(f"{'time_s < 1 and ' * 20}tim_s > 1")
    _, line, caret = str(caught.value).splitlines()
    assert len(line) < 90
    assert line[caret.index("^") : caret.rindex("^") + 1] == "tim_s"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("state == 'finished'", "column 1: a measure is a number, and this is true or false"),
        ("always(t < 3)", "--ensure"),
        ("state", "this is a text"),
        ("log", "this is a list"),
        ("None", "this is None"),
    ],
)
def test_what_is_no_number_is_no_measure(text, words):
    with pytest.raises(UsageError, match=words):
        parse_measure(text)


PARTS = (
    *(
        "time_s",
        "state",
        "globals",
        "signals",
        "joints",
        "tcp_pose",
        "alarms",
        "log",
        "warnings",
        "findings.warning",
        "contacts",
        "clearance",
    ),
    *("t", "q", "qd", "tcp", "tcp_speed", "line", "signal('flag[0]')", "globals['a']", "globals['b']", "pi", "None"),
    *("True", "0", "1", "-1", "0.5", "'x'", "[1, 2]", "[0]", "['a']", "(", ")", "and", "or", "not", "<", "==", "!="),
    *("in", "is", "+", "-", "*", "/", "//", "%", "**", "always(", "before(", "max_of(", "count(", "len(", "sqrt(", ","),
    *("if", "else", ":", ".", "hypot(", "sum(", "round(", "min("),
)


def fuzz(seeds, count):
    """Parse random texts and work out those that are expressions; return how many were."""
    run_of = VirtualRobot("CS66")
    text = "def p():\n  global a, b\n  a = [1, 'x', None, {'k': (2, 3)}, 2 ** 2000]\n  b = 0\n  sleep(0.01)\nend\n"
    unit = run_of.compile(text)
    found = 0
    for seed in seeds:
        rng = Random(seed)
        properties, measures = [], {}
        for index in range(count):
            text = " ".join(rng.choice(PARTS) for _ in range(rng.randrange(1, 9)))
            text = text.replace(" [", "[") + ")" * max(0, text.count("(") - text.count(")"))
            for parse, add in ((parse_property, properties.append), (parse_measure, None)):
                try:
                    parsed = parse(text, ["a", "b"])
                except UsageError:
                    continue
                measures.update({str(index): parsed}) if add is None else add(parsed)
        watching = Checks(properties, measures).watch()
        run = VirtualRobot(run_of.model).run(unit, trace=watching.trace)
        results = watching.results(run)
        found += len(results.verdicts) + len(results.measures)
        for one, verdict in zip(properties, results.verdicts, strict=True):
            assert verdict.holds or verdict.words, one.text
        for name, value in results.measures.items():
            assert (value is None) == (name in results.reasons)
    return found


def test_random_texts_are_refused_or_come_to_something():
    assert fuzz(range(3), 500) > 10


@pytest.mark.invariants
@pytest.mark.slow
def test_many_random_texts_are_refused_or_come_to_something():
    assert fuzz(range(100, 200), 2000) > 5_000


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("warnings == 0", r"write findings\.warning, .*, or len\(warnings\)"),
        ("findings.warnings == 0", "there is no 'warnings' here; did you mean"),
        ("globals.good == 3", r'write globals\["good"\]'),
        ("findings == 0", "write findings.error, findings.warning"),
        ("state.x == 0", "a dot is not possible here"),
    ],
)
def test_the_right_form_is_named(text, words):
    with pytest.raises(UsageError, match=words):
        parse_property(text)
