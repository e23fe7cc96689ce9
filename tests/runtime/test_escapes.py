"""Attempts to get from a program to the interpreter and the computer. Each must fail, and say why.

A program hands what it has got hold of to `leak`. What must never arrive there: frames, code objects, tracebacks,
real modules, functions of the computer, objects of the runtime.
"""

from __future__ import annotations

import os

import pytest

from elitescript.errors import ProgramError
from tests.runtime.crawler import forbidden
from tests.runtime.machine import Bench, compiled

REFUSED = "refused"
"""The text does not compile."""


class Leaked(AssertionError):
    """A program got hold of something."""


def attempt(body, tmp=None):
    """Run a body; return how it ended: `REFUSED`, the class of its alarm, or `finished`."""
    caught = []
    lines = "".join(f"  {line}\n" for line in body.strip("\n").split("\n"))
    try:
        unit = compiled(f"def job():\n{lines}end\n")
    except ProgramError as error:
        assert any(problem.is_error for problem in error.problems)
        return REFUSED
    bench = Bench()
    bench.host.start(unit, {"leak": caught.append})
    bench.run(until=500)
    for value in caught:
        why = forbidden(value, bench)
        if why:
            raise Leaked(f"{why}: {value!r}")
    if bench.alarms:
        alarm = bench.alarms[0]
        assert alarm.text and alarm.line > 0
        assert os.sep + "root" not in alarm.text and "elitescript/" not in alarm.text
        return alarm.class_name
    assert bench.ends == ["finished"]
    return "finished"


SPELLED = {
    # chains of special attributes
    "class tree": "leak(().__class__.__base__.__subclasses__())",
    "mro": "leak(int.mro())",
    "__mro__": "leak(int.__mro__)",
    "__bases__": "leak(int.__bases__)",
    "__subclasses__": "leak(object.__subclasses__())",
    "function globals": "leak(sleep.__globals__)",
    "own globals": "def f():\n  pass\nleak(f.__globals__)",
    "code": "def f():\n  pass\nleak(f.__code__)",
    "closure": "x = 1\ndef f():\n  return x\nleak(f.__closure__)",
    "defaults": "def f(a=1):\n  pass\nleak(f.__defaults__)",
    "method self": "leak(sin.__self__)",
    "method func": "class C:\n  def m(self):\n    pass\nleak(C().m.__func__)",
    "builtins by name": "leak(__builtins__)",
    "import by name": "leak(__import__('os'))",
    "loader": "import math\nleak(math.__loader__)",
    "spec": "import math\nleak(math.__spec__)",
    "dict": "import math\nleak(math.__dict__)",
    "class dict": "class C:\n  pass\nleak(C.__dict__)",
    "module name": "leak(__name__)",
    "reduce": "leak([].__reduce_ex__(2))",
    "getattribute": "leak(object.__getattribute__(1, 'real'))",
    "class getattribute": "leak(type(1).__getattribute__)",
    "init globals": "import queue\nleak(queue.Queue.__init__.__globals__)",
    "weakref": "class C:\n  pass\nleak(C.__weakref__)",
    "text signature": "leak(len.__text_signature__)",
    # frames and tracebacks
    "generator frame": "def g():\n  yield 1\nleak(g().gi_frame)",
    "generator code": "def g():\n  yield 1\nleak(g().gi_code)",
    "traceback": "try:\n  1 / 0\nexcept ZeroDivisionError as e:\n  leak(e.__traceback__)",
    "traceback frame": "try:\n  1 / 0\nexcept ZeroDivisionError as e:\n  leak(e.tb_frame)",
    "with_traceback": "leak(ValueError().with_traceback)",
    "context": "try:\n  1 / 0\nexcept ZeroDivisionError as e:\n  leak(e.__context__)",
    "exit frame": "class C:\n  def __enter__(self):\n    pass\n  def __exit__(self, t, v, tb):\n    leak(tb.tb_frame)\n"
    "with C():\n  1 / 0",
    "f_back": "leak(getattr.f_back)",
    # definitions
    "metaclass": "class C(metaclass=type):\n  pass",
    "__init_subclass__": "class C:\n  def __init_subclass__(cls):\n    pass",
    "__class_getitem__": "class C:\n  def __class_getitem__(cls, x):\n    pass",
    "__getattr__": "class C:\n  def __getattr__(self, name):\n    pass",
    "__del__": "class C:\n  def __del__(self):\n    pass",
    "__reduce__": "class C:\n  def __reduce__(self):\n    return (exit, ())",
    "__match_args__": "class C:\n  __match_args__ = ('__globals__',)",
    "__set_name__": "class C:\n  def __set_name__(self, owner, name):\n    pass",
    "store class": "class C:\n  pass\nC().__class__ = int",
    "store method": "class C:\n  pass\nC.__eq__ = lambda a, b: True",
    "class keyword": "class C(a=1):\n  pass",
    "async": "async def f():\n  pass",
    "except star": "try:\n  pass\nexcept* ValueError:\n  pass",
    "mangled": "class C:\n  def f(self):\n    return self.__dict__\nleak(C().f())",
    "full-width letters": "leak(().__\uff43lass__.__b\uff41se__)",
    "look-alike underscores": "leak(()._\uff3fclass_\uff3f.__base__)",
    # patterns
    "pattern keyword": "def f():\n  pass\nmatch f:\n  case object(__globals__=g):\n    leak(g)",
    "pattern frame": "def g():\n  yield\nmatch g():\n  case object(gi_frame=f):\n    leak(f)",
    "pattern format": "match 'x':\n  case str(format=f):\n    leak(f('{0.__class__}', 1))",
    "pattern position": "class C:\n  pass\nmatch C():\n  case C(a):\n    leak(a)",
    # f-strings
    "f-string": "leak(f'{().__class__.__base__}')",
    "f-string self": "leak(f'{sleep.__globals__=}')",
    "f-string spec": "leak(f'{1:{().__class__.__base__}}')",
    # imports
    "import dunder": "from math import __loader__\nleak(__loader__)",
    "import as dunder": "import math as __builtins__",
    "future": "import __future__",
}


@pytest.mark.parametrize("body", SPELLED.values(), ids=SPELLED)
def test_what_is_spelled_out_does_not_compile(body):
    assert attempt(body) == REFUSED


COMPUTED = {
    # names computed at run time
    "getattr": ("leak(getattr((), '__cla' + 'ss__').__base__)", REFUSED),
    "getattr globals": ("leak(getattr(sleep, '__glo' + 'bals__'))", "PermissionError"),
    "getattr frame": ("def g():\n  yield\nleak(getattr(g(), 'gi_fr' + 'ame'))", "PermissionError"),
    "getattr default": ("leak(getattr(sleep, '__code__', None))", "PermissionError"),
    "getattr subclass of str": (
        "class S(str):\n  def __eq__(self, other):\n    return False\n  def __hash__(self):\n    return 1\n"
        "leak(getattr(sleep, S('__globals__')))",
        "TypeError",
    ),
    "getattr in map": ("leak(list(map(getattr, [sleep], ['__globals__'])))", "PermissionError"),
    "getattr reduce": (
        "import functools\nleak(functools.reduce(getattr, ['__class__', '__base__'], ()))",
        "PermissionError",
    ),
    "getattr partial": ("import functools\nleak(functools.partial(getattr, sleep)('__globals__'))", "PermissionError"),
    "getattr hook": ("leak(getattr(1, '@attribute'))", "AttributeError"),
    "setattr class": ("class C:\n  pass\nsetattr(C(), '__class__', int)", "PermissionError"),
    "setattr code": ("def f():\n  pass\nsetattr(f, '__code__', f)", "PermissionError"),
    "setattr method": ("class C:\n  pass\nsetattr(C, '__getattr__', lambda s, n: 1)", "PermissionError"),
    "delattr": ("class C:\n  pass\ndelattr(C, '__doc__')", "PermissionError"),
    "vars": ("leak(vars())", "PermissionError"),
    "vars of module": ("import math\nleak(vars(math))", "PermissionError"),
    "globals": ("leak(globals())", "PermissionError"),
    "locals": ("leak(locals())", "PermissionError"),
    "dir": ("leak(dir())", "PermissionError"),
    "memoryview": ("leak(memoryview(b'x'))", "PermissionError"),
    "breakpoint": ("breakpoint()", "PermissionError"),
    "help": ("help()", "PermissionError"),
    "input": ("leak(input())", "RuntimeError"),
    "type of three": ("leak(type('C', (), {'__getattr__': lambda s, n: n}))", "PermissionError"),
    "type of type": ("leak(type(type(1))('C', (), {}).__name__)", "PermissionError"),
    "stop class": ("leak(GreenletExit)", "NameError"),
    # format strings
    "format": ("leak('{0.__class__.__base__}'.format(1))", "PermissionError"),
    "format globals": ("leak('{0.__globals__}'.format(sleep))", "PermissionError"),
    "format by name": ("leak('{f.__globals__}'.format(f=sleep))", "PermissionError"),
    "format unbound": ("leak(str.format('{0.__globals__}', sleep))", "PermissionError"),
    "format in map": ("leak(list(map(str.format, ['{0.__globals__}'], [sleep])))", "PermissionError"),
    "format in a lambda": ("f = lambda s: s.format\nleak(f('{0.__globals__}')(sleep))", "PermissionError"),
    "format in a short list": (
        "s = '{0.__globals__}'\nleak([s.format for i in range(9)][0](sleep))",
        "PermissionError",
    ),
    "format in a short loop": (
        "s = '{0.__globals__}'\nf = 0\nfor i in range(9):\n  f = s.format\nleak(f(sleep))",
        "PermissionError",
    ),
    "format_map": ("leak('{f.__globals__}'.format_map({'f': sleep}))", "PermissionError"),
    "format getattr": ("leak(getattr('{0.__globals__}', 'format')(sleep))", "PermissionError"),
    "format super": (
        "class S(str):\n  def go(self, x):\n    return super().format(x)\nleak(S('{0.__globals__}').go(sleep))",
        "PermissionError",
    ),
    "format spec": ("leak('{0:{1.__globals__}}'.format(1, sleep))", "PermissionError"),
    "format of format": ("leak('{0.format.__self__}'.format('{0.__globals__}'))", "PermissionError"),
    "format gi_frame": ("def g():\n  yield\nleak('{0.gi_frame.f_globals}'.format(g()))", "PermissionError"),
    "UserString": (
        "import collections\nleak(collections.UserString('{0.__globals__}').format(sleep))",
        "AttributeError",
    ),
    "string.Formatter": ("import string\nleak(string.Formatter().format('{0.__globals__}', sleep))", "AttributeError"),
    # eval and exec
    "eval": ("leak(eval('().__class__.__base__'))", "SyntaxError"),
    "eval builtins": ("leak(eval('__builtins__'))", "SyntaxError"),
    "eval own builtins": ("leak(eval('x', {'__builtins__': {'x': 1}}))", "PermissionError"),
    "eval of code": ("leak(eval(b'1'))", "TypeError"),
    "eval in a thread": ("start_thread(eval, ('leak(self)',))\nsleep(0.1)", "NameError"),
    "eval in a thread, function": ("start_thread(eval, ('leak(function)',))\nsleep(0.1)", "NameError"),
    "eval in statistics": (
        "import statistics\nstatistics.mean(map(eval, ['leak(data)', 'leak(function)']))",
        "NameError",
    ),
    "eval in threading": (
        "import threading\nt = threading.Thread(target=eval, args=('leak(self)',))\nt.start()\nt.join()",
        "NameError",
    ),
    "exec": ("exec('leak(().__class__.__base__)')", "SyntaxError"),
    "exec import": ("exec('import os\\nos.system(1)')", "AttributeError"),
    "compile": ("leak(compile('1', 'x', 'eval'))", "PermissionError"),
    "main": ("exec('leak(1)')\nleak(job)", "NameError"),
    # modules that are not there
    **{
        f"import {name}": (f"import {name}\nleak({name.partition('.')[0]})", "ImportError")
        for name in (
            "builtins",
            "codecs",
            "ctypes",
            "gc",
            "greenlet",
            "http.client",
            "importlib",
            "inspect",
            "io",
            "marshal",
            "multiprocessing",
            "pathlib",
            "pickle",
            "shutil",
            "socket",
            "ssl",
            "tempfile",
            "traceback",
            "types",
            "urllib.request",
            "weakref",
            "xmlrpc.client",
            "zipimport",
            "_thread",
            "_io",
            "elitescript",
            "elitescript.runtime.host",
            "os.system",
            "json.decoder",
            "threading._os",
        )
    },
    # modules behind modules
    "from json import decoder": ("from json import decoder\nleak(decoder)", "ImportError"),
    "from json import codecs": ("from json import codecs\nleak(codecs)", "ImportError"),
    "from re import enum": ("from re import enum\nleak(enum)", "ImportError"),
    "from os import system": ("from os import system\nleak(system)", "ImportError"),
    "from threading import _os": ("from threading import _os\nleak(_os)", "ImportError"),
    "threading._sys": ("import threading\nleak(threading._sys)", "AttributeError"),
    "random._os": ("import random\nleak(random._os)", "AttributeError"),
    "random._urandom": ("import random\nleak(random._urandom)", "AttributeError"),
    "json.codecs": ("import json\nleak(json.codecs)", "AttributeError"),
    "json.scanner": ("import json\nleak(json.scanner)", "AttributeError"),
    "collections._sys": ("import collections\nleak(collections._sys)", "AttributeError"),
    "os.system": ("import os\nos.system('true')", "AttributeError"),
    "os.fork": ("import os\nos.fork()", "AttributeError"),
    "os.open": ("import os\nos.open('/etc/passwd', 0)", "AttributeError"),
    "os.path module": ("import os.path\nleak(os.path.os)", "AttributeError"),
    "sys.modules": ("import sys\nleak(sys.modules)", "AttributeError"),
    "sys._getframe": ("import sys\nleak(sys._getframe())", "AttributeError"),
    "sys.settrace": ("import sys\nsys.settrace(leak)", "AttributeError"),
    "sys.stdout inside": ("import sys\nleak(sys.stdout.buffer)", "AttributeError"),
    "operator.attrgetter": ("import operator\nleak(operator.attrgetter('__globals__')(sleep))", "AttributeError"),
    "operator.methodcaller": ("import operator\nleak(operator.methodcaller('x')(1))", "AttributeError"),
    "functools.singledispatch": ("import functools\nfunctools.singledispatch(leak)", "AttributeError"),
    "functools.wraps": (
        "import functools\nclass C:\n  pass\nfunctools.update_wrapper(C(), sleep, ('__globals__',))",
        "TypeError",
    ),
    "enum of a module": (
        "import enum\nleak(enum.IntEnum._convert_('X', 'os', lambda n: True))",
        "KeyError",
    ),
    "enum of itself": (
        "import enum\nE = enum.Enum._convert_('X', 'enum', lambda n: n == 'bltns')\nleak(E.bltns.value)",
        "KeyError",
    ),
    "enum of the flags of re": ("import re\nleak(re.I._convert_('X', 'os', lambda n: True))", "AttributeError"),
    "make_dataclass": ("import dataclasses\ndataclasses.make_dataclass('X', ['a'])", "AttributeError"),
    "typing.get_type_hints": (
        "import typing\ndef f(a: '().__class__'):\n  pass\nleak(typing.get_type_hints(f))",
        "AttributeError",
    ),
    "typing.ForwardRef": ("import typing\nleak(typing.ForwardRef('1'))", "AttributeError"),
    "typing.List": ("import typing\nleak(typing.List['().__class__']._evaluate({}, {}))", "AttributeError"),
    "namedtuple code": (
        "import collections\nclass S(str):\n  def isidentifier(self):\n    return True\n"
        "collections.namedtuple('P', [S('a=leak(1)')])",
        "ValueError",
    ),
    "dataclass module": (
        "import dataclasses\n@dataclasses.dataclass\nclass C:\n  a: '().__class__' = 1\nleak(C().a)",
        "finished",
    ),
    "copy of a lock": ("import threading\nleak(copy.copy(threading.Lock()))", "TypeError"),
    "copy of a method": ("import threading\nleak(copy.deepcopy(threading.Lock().acquire))", "TypeError"),
    "copy of a module": ("import math\nleak(copy.deepcopy(math))", "TypeError"),
    "class of a module": ("import math\ntype(math).x = 1", "TypeError"),
    "patched module": ("import math\nmath.pi = 3", "AttributeError"),
    # inside objects of the runtime
    "lock inside": ("import queue\nleak(queue.Queue().mutex._mutex)", "AttributeError"),
    "lock saved state": ("import threading\nr = threading.RLock()\nr.acquire()\nleak(r._release_save())", "finished"),
    "lock by hand": ("import threading\nleak(type(threading.Lock())().acquire())", "AttributeError"),
    "thread handle": (
        "import threading\nt = threading.current_thread()\nleak(getattr(t, '_handle', 0))\nleak(t._tstate_lock)\n",
        None,
    ),
    "thread hook": ("import threading\nleak(threading.current_thread()._invoke_excepthook)", "finished"),
    "thread local": ("import threading\nleak(threading.local()._space)", "AttributeError"),
    "exception of a command": (
        "try:\n  sin('x')\nexcept TypeError as e:\n  leak(e)\n  leak(e.value)\n  leak(e.args)\n  leak(e.command)",
        "finished",
    ),
    "exception object": ("try:\n  sleep.nothing\nexcept AttributeError as e:\n  leak(e.obj)", "finished"),
    "generator of ours": ("import itertools\nleak(itertools.count().gi_frame)", REFUSED),
    "subprocess": ("import subprocess\nsubprocess.Popen(['sh', '-c', 'true'])", "PermissionError"),
    "subprocess shell": ("import subprocess\nsubprocess.run('ps; rm x', shell=True)", "PermissionError"),
    "kill a real process": ("import os\nos.kill(1, 9)", "ProcessLookupError"),
    # files
    "open": ("open('/etc/passwd')", "PermissionError"),
    "open up": ("open('../secret')", "PermissionError"),
    "open a descriptor": ("open(0)", "TypeError"),
    "open a path object": ("class P:\n  def __fspath__(self):\n    return '/etc/passwd'\nopen(P())", REFUSED),
}


@pytest.mark.parametrize(("body", "outcome"), COMPUTED.values(), ids=COMPUTED)
def test_what_is_computed_is_refused_when_it_runs(body, outcome):
    found = attempt(body)
    if outcome is not None:
        assert found == outcome


def test_a_class_pattern_takes_no_attribute_that_programs_may_not_read():
    body = """
metatype = (1).__class__.__class__
Any = metatype("Any", (metatype,), {"__instancecheck__": lambda cls, value: True})
int = Any("int", (), {"__match_args__": ("__globals__",)})
match sleep:
  case int(found):
    leak(found)
"""
    assert attempt(body) == REFUSED


def test_there_are_many():
    assert len(SPELLED) + len(COMPUTED) >= 60


def test_a_leak_is_noticed():
    """The detector itself: a module that a test plants does arrive."""
    bench = Bench()
    assert forbidden(os, bench)
    assert forbidden(bench.host._scheduler, bench)
    assert not forbidden([1], bench)
