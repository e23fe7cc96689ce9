"""Stands in for `unittest` and `test.support` in programs that are sliced out of CPython's own tests.

The slicer takes from this file what a test method needs, so it is a program too: nothing here that the language policy
refuses. Each assertion notes its operands before it compares them, so that two runs are compared by what they have
computed, and not only by their verdict.
"""

# ruff: noqa
# mypy: ignore-errors
from __future__ import annotations

import contextlib

FOREIGN_NOTES_MAX = 3000
FOREIGN_TEXT_MAX = 600
foreign_notes = []
foreign_end = []


def foreign_text(value):
    try:
        text = repr(value)
    except Exception as error:
        return "<no text: " + type(error).__name__ + ">"
    if len(text) > FOREIGN_TEXT_MAX:
        text = text[:FOREIGN_TEXT_MAX] + "... " + str(len(text)) + " characters"
    return text.encode("ascii", "backslashreplace").decode("ascii")


def foreign_note(what, *operands):
    if len(foreign_notes) < FOREIGN_NOTES_MAX:
        foreign_notes.append([what, *[foreign_text(operand) for operand in operands]])


def foreign_fail(msg, text):
    raise AssertionError(text if msg is None else str(msg))


class SkipTest(Exception):
    pass


class Namespace:
    def __init__(self, **names):
        for name in names:
            setattr(self, name, names[name])


def foreign_run(kind, name):
    try:
        if hasattr(kind, "foreign_skip"):
            raise SkipTest(kind.foreign_skip)
        case = kind(name)
        kind.setUpClass()
        try:
            case.setUp()
            try:
                getattr(case, name)()
            finally:
                case.tearDown()
                case.doCleanups()
        finally:
            kind.tearDownClass()
        foreign_end.append(["passed", "", ""])
    except SkipTest as error:
        foreign_end.append(["skipped", "", ""])
    except AssertionError as error:
        foreign_end.append(["failed", "AssertionError", foreign_text(str(error))])
        raise
    except Exception as error:
        foreign_end.append(["error", type(error).__name__, foreign_text(str(error))])
        raise


def skip(reason):
    def skipped(test):
        if isinstance(test, type):
            test.foreign_skip = str(reason)
            return test

        def raises(*arguments, **keywords):
            raise SkipTest(str(reason))

        return raises

    return skipped


def skipIf(condition, reason):
    return skip(reason) if condition else foreign_same


def skipUnless(condition, reason):
    return foreign_same if condition else skip(reason)


def foreign_same(test):
    return test


def expectedFailure(test):
    return test


class foreign_Raises:
    def __init__(self, expected, pattern, msg):
        self.expected = expected
        self.pattern = pattern
        self.msg = msg

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if kind is None:
            foreign_fail(self.msg, foreign_text(self.expected) + " not raised")
        if not issubclass(kind, self.expected):
            return False
        self.exception = error
        foreign_note("raises", kind)
        foreign_note("message", str(error))
        if self.pattern is not None:
            import re

            if not re.search(self.pattern, str(error)):
                foreign_fail(self.msg, foreign_text(self.pattern) + " does not match " + foreign_text(str(error)))
        return True


class TestCase:
    failureException = AssertionError
    longMessage = True
    maxDiff = None

    def __init__(self, methodName="runTest"):
        self._testMethodName = methodName
        self.foreign_cleanups = []

    @classmethod
    def setUpClass(cls):
        pass

    @classmethod
    def tearDownClass(cls):
        pass

    def setUp(self):
        pass

    def tearDown(self):
        pass

    def doCleanups(self):
        while self.foreign_cleanups:
            function, arguments, keywords = self.foreign_cleanups.pop()
            function(*arguments, **keywords)

    def addCleanup(self, function, /, *arguments, **keywords):
        self.foreign_cleanups.append((function, arguments, keywords))

    def enterContext(self, context):
        value = context.__enter__()
        self.addCleanup(context.__exit__, None, None, None)
        return value

    def id(self):
        return self._testMethodName

    def countTestCases(self):
        return 1

    def shortDescription(self):
        return None

    @contextlib.contextmanager
    def subTest(self, msg=None, **parameters):
        yield

    def skipTest(self, reason):
        raise SkipTest(str(reason))

    def fail(self, msg=None):
        foreign_note("fail", msg)
        foreign_fail(msg, "failed")

    def assertTrue(self, expr, msg=None):
        foreign_note("true", expr)
        if not expr:
            foreign_fail(msg, foreign_text(expr) + " is not true")

    def assertFalse(self, expr, msg=None):
        foreign_note("false", expr)
        if expr:
            foreign_fail(msg, foreign_text(expr) + " is not false")

    def assertEqual(self, first, second, msg=None):
        foreign_note("equal", first, second)
        if not first == second:
            foreign_fail(msg, foreign_text(first) + " != " + foreign_text(second))

    def _assertNotEqual(self, first, second, msg=None):
        foreign_note("not equal", first, second)
        if not first != second:
            foreign_fail(msg, foreign_text(first) + " == " + foreign_text(second))

    def assertNotEqual(self, first, second, msg=None):
        self._assertNotEqual(first, second, msg)

    def assertMultiLineEqual(self, first, second, msg=None):
        TestCase.assertEqual(self, first, second, msg)

    def assertSequenceEqual(self, first, second, msg=None, seq_type=None):
        foreign_note("sequence", first, second)
        if seq_type is not None and not (isinstance(first, seq_type) and isinstance(second, seq_type)):
            foreign_fail(msg, "not of the type " + foreign_text(seq_type))
        if not (first == second or list(first) == list(second)):
            foreign_fail(msg, foreign_text(first) + " != " + foreign_text(second))

    def assertListEqual(self, first, second, msg=None):
        self.assertSequenceEqual(first, second, msg, seq_type=list)

    def assertTupleEqual(self, first, second, msg=None):
        self.assertSequenceEqual(first, second, msg, seq_type=tuple)

    def assertSetEqual(self, first, second, msg=None):
        foreign_note("set", len(first), len(second))
        if first.difference(second) or second.difference(first):
            foreign_fail(msg, foreign_text(first) + " != " + foreign_text(second))

    def assertDictEqual(self, first, second, msg=None):
        foreign_note("dict", first, second)
        if first != second:
            foreign_fail(msg, foreign_text(first) + " != " + foreign_text(second))

    def assertDictContainsSubset(self, subset, dictionary, msg=None):
        foreign_note("subset", subset, dictionary)
        for key in subset:
            if key not in dictionary or dictionary[key] != subset[key]:
                foreign_fail(msg, foreign_text(key) + " differs")

    def assertCountEqual(self, first, second, msg=None):
        first, rest = list(first), list(second)
        foreign_note("count", len(first), len(rest))
        for part in first:
            if part not in rest:
                foreign_fail(msg, foreign_text(part) + " is missing")
            rest.remove(part)
        if rest:
            foreign_fail(msg, foreign_text(rest) + " is left")

    def assertIs(self, first, second, msg=None):
        foreign_note("is", first is second, first)
        if first is not second:
            foreign_fail(msg, foreign_text(first) + " is not " + foreign_text(second))

    def assertIsNot(self, first, second, msg=None):
        foreign_note("is not", first is not second, first)
        if first is second:
            foreign_fail(msg, "unexpectedly identical: " + foreign_text(first))

    def assertIsNone(self, first, msg=None):
        foreign_note("none", first)
        if first is not None:
            foreign_fail(msg, foreign_text(first) + " is not None")

    def assertIsNotNone(self, first, msg=None):
        foreign_note("not none", first)
        if first is None:
            foreign_fail(msg, "unexpectedly None")

    def assertIn(self, member, container, msg=None):
        foreign_note("in", member, container)
        if member not in container:
            foreign_fail(msg, foreign_text(member) + " not found in " + foreign_text(container))

    def assertNotIn(self, member, container, msg=None):
        foreign_note("not in", member, container)
        if member in container:
            foreign_fail(msg, foreign_text(member) + " found in " + foreign_text(container))

    def assertIsInstance(self, value, kind, msg=None):
        foreign_note("instance", type(value))
        if not isinstance(value, kind):
            foreign_fail(msg, foreign_text(value) + " is not an instance of " + foreign_text(kind))

    def assertNotIsInstance(self, value, kind, msg=None):
        foreign_note("no instance", type(value))
        if isinstance(value, kind):
            foreign_fail(msg, foreign_text(value) + " is an instance of " + foreign_text(kind))

    def assertLess(self, first, second, msg=None):
        foreign_note("less", first, second)
        if not first < second:
            foreign_fail(msg, foreign_text(first) + " not less than " + foreign_text(second))

    def assertLessEqual(self, first, second, msg=None):
        foreign_note("less or equal", first, second)
        if not first <= second:
            foreign_fail(msg, foreign_text(first) + " not less than or equal to " + foreign_text(second))

    def assertGreater(self, first, second, msg=None):
        foreign_note("greater", first, second)
        if not first > second:
            foreign_fail(msg, foreign_text(first) + " not greater than " + foreign_text(second))

    def assertGreaterEqual(self, first, second, msg=None):
        foreign_note("greater or equal", first, second)
        if not first >= second:
            foreign_fail(msg, foreign_text(first) + " not greater than or equal to " + foreign_text(second))

    def assertAlmostEqual(self, first, second, places=None, msg=None, delta=None):
        foreign_note("almost", first, second)
        if first == second:
            return
        difference = abs(first - second)
        if delta is not None:
            if not difference <= delta:
                foreign_fail(msg, foreign_text(first) + " != " + foreign_text(second) + " within delta")
        elif round(difference, 7 if places is None else places) != 0:
            foreign_fail(msg, foreign_text(first) + " != " + foreign_text(second) + " within places")

    def assertNotAlmostEqual(self, first, second, places=None, msg=None, delta=None):
        foreign_note("not almost", first, second)
        difference = abs(first - second)
        if delta is not None:
            if first == second or difference <= delta:
                foreign_fail(msg, foreign_text(first) + " == " + foreign_text(second) + " within delta")
        elif first == second or round(difference, 7 if places is None else places) == 0:
            foreign_fail(msg, foreign_text(first) + " == " + foreign_text(second) + " within places")

    def assertRegex(self, text, expected_regex, msg=None):
        import re

        foreign_note("regex", text)
        if isinstance(expected_regex, (str, bytes)):
            expected_regex = re.compile(expected_regex)
        if not expected_regex.search(text):
            foreign_fail(msg, "the pattern is not found in " + foreign_text(text))

    def assertNotRegex(self, text, unexpected_regex, msg=None):
        import re

        foreign_note("no regex", text)
        if isinstance(unexpected_regex, (str, bytes)):
            unexpected_regex = re.compile(unexpected_regex)
        if unexpected_regex.search(text):
            foreign_fail(msg, "the pattern is found in " + foreign_text(text))

    def assertRaises(self, expected_exception, *arguments, **keywords):
        if not arguments:
            return foreign_Raises(expected_exception, None, keywords.get("msg"))
        with foreign_Raises(expected_exception, None, None):
            arguments[0](*arguments[1:], **keywords)

    def assertRaisesRegex(self, expected_exception, expected_regex, *arguments, **keywords):
        if not arguments:
            return foreign_Raises(expected_exception, expected_regex, keywords.get("msg"))
        with foreign_Raises(expected_exception, expected_regex, None):
            arguments[0](*arguments[1:], **keywords)

    @contextlib.contextmanager
    def foreign_warns(self, expected, pattern):
        import warnings

        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always")
            yield found
        if not [warning for warning in found if issubclass(warning.category, expected)]:
            foreign_fail(None, "no warning")

    def assertWarns(self, expected_warning, *arguments, **keywords):
        if not arguments:
            return self.foreign_warns(expected_warning, None)
        with self.foreign_warns(expected_warning, None):
            arguments[0](*arguments[1:], **keywords)

    def assertWarnsRegex(self, expected_warning, expected_regex, *arguments, **keywords):
        if not arguments:
            return self.foreign_warns(expected_warning, expected_regex)
        with self.foreign_warns(expected_warning, expected_regex):
            arguments[0](*arguments[1:], **keywords)

    # Names that Python 3.12 has taken out.
    assertEquals = failUnlessEqual = assertEqual
    assertNotEquals = assertNotEqual
    assertRaisesRegexp = assertRaisesRegex
    assertRegexpMatches = assertRegex
    assertNotRegexpMatches = assertNotRegex
    assertAlmostEquals = assertAlmostEqual
    assert_ = assertTrue


# Of `test.support`: what asks for the interpreter, the computer or a resource there.
verbose = 0
SHORT_TIMEOUT = 30.0
LONG_TIMEOUT = 300.0
LOOPBACK_TIMEOUT = 5.0
Py_DEBUG = False
MS_WINDOWS = False
is_android = False
is_emscripten = False
is_wasi = False
has_fork_support = False
has_subprocess_support = False
HAVE_DOCSTRINGS = True
max_memuse = 0
real_max_memuse = 0
TESTFN = "foreign_file"


def check_impl_detail(**guards):
    return guards.get("cpython", not guards or True not in guards.values())


def cpython_only(test):
    return test


def impl_detail(msg=None, **guards):
    return foreign_same if check_impl_detail(**guards) else skip(msg)


def gc_collect():
    pass


def no_tracing(test):
    return test


def refcount_test(test):
    return test


def skip_if_pgo_task(test):
    return test


def skip_if_sanitizer(reason=None, **which):
    return foreign_same


def requires_docstrings(test):
    return test


def requires_IEEE_754(test):
    return test


def requires_zlib(reason=None):
    return foreign_same


def requires_working_threading(module=False):
    return foreign_same


def requires_resource(resource):
    return skip("the resource " + resource)


def requires(resource, msg=None):
    raise SkipTest("the resource " + resource)


def is_resource_enabled(resource):
    return False


def bigmemtest(size, memuse, dry_run=True):
    return skip("much memory")


def bigaddrspacetest(test):
    return skip("much memory")(test)


def reap_threads(test):
    return test


def threading_setup():
    return (0, 0)


def threading_cleanup(*before):
    pass


def run_with_locale(*names):
    return skip("locales")


def run_with_tz(zone):
    return skip("time zones")


@contextlib.contextmanager
def infinite_recursion(max_depth=None):
    yield


@contextlib.contextmanager
def wait_threads_exit(timeout=None):
    yield
