"""Endless programs: each command and each function of a module in a loop, accepted and refused, and what else is slow.

A call that needs what is not there (a device, a file) is refused in both forms; so much the better.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition import quantities
from elitescript.commands.definition.registry import Command, Param
from elitescript.language.modules import COPIED_NAMES, SHARED_NAMES

POSE: Final = "[-0.4, -0.1, 0.4, 3.1, 0.0, 0.0]"
JOINTS: Final = "[0.0, -1.57, 1.2, -1.2, -1.57, 0.0]"
LEFT_OUT: Final = frozenset({"halt", "powerdown", "exit"})
"""Commands that end the loop."""


def programs() -> dict[str, str]:
    """Return all programs by name."""
    found: dict[str, str] = {}
    for name in sorted(CATALOGUE.names()):
        command = CATALOGUE.get(name)
        if command is None or name in LEFT_OUT:
            continue
        found[f"{name} accepted"] = looping(accepted_call(name, command))
        found[f"{name} refused"] = looping(refused_call(name, command))
    for name, text in (*_functions(), *FURTHER.items()):
        found[name] = text if text.startswith("def ") else looping(text)
    return found


def looping(call: str, setup: str = "") -> str:
    """Return a program that makes a call without end, whatever comes of it."""
    *before, last = call.split("\n")
    lines = [*(setup.split("\n") if setup else []), *before, "while True:", "  try:", f"    {last}"]
    lines += ["  except Exception:", "    pass", "  end", "end"]
    return "def job():\n" + "\n".join(f"  {line}" for line in lines) + "\nend\n"


def accepted_call(name: str, command: Command) -> str:
    """Return a call with arguments in their ranges, no more than have to be."""
    if name == "start_thread":
        return "start_thread(lambda: None, ())"
    needed = [param for param in command.params if param.is_required]
    return f"{name}({', '.join(map(_value, needed))})"


def refused_call(name: str, command: Command) -> str:
    """Return a call that is refused: a first argument that nothing takes, or one that is too many."""
    needed = [param for param in command.params if param.is_required]
    if not needed or isinstance(needed[0].quantity, quantities.Anything):
        return f"{name}({', '.join(['1'] * (len(command.params) + 3))})"
    return f"{name}({', '.join(['{}', *map(_value, needed[1:])])})"


def _value(param: Param) -> str:
    return _value_of(param.quantity)


def _value_of(quantity: Any) -> str:
    if quantity.meaning == "pose":
        return POSE
    if quantity.meaning == "joints":
        return JOINTS
    kind = type(quantity).__name__
    if kind == "Vector":
        return f"[{', '.join([_value_of(quantity.element)] * (quantity.count or 2))}]"
    if kind == "Choice":
        return repr(quantity.choices[0])
    if kind == "Either":
        return _value_of(quantity.kinds[0])
    if kind == "Optionally":
        return _value_of(quantity.inner)
    if kind == "Integer":
        return str(quantity.low or 0)
    if kind == "Number":
        low = 0.0 if quantity.low is None else quantity.low
        return repr(low + 0.1 if quantity.high is None or low + 0.1 <= quantity.high else low)
    return {"Boolean": "True", "Text": '"a"'}.get(kind, "1")


def _functions() -> Iterator[tuple[str, str]]:
    """Yield a loop for each function of a module, called with a number, and one with too many arguments."""
    for module, wanted in {**SHARED_NAMES, **COPIED_NAMES}.items():
        real = __import__(module, fromlist=["x"])
        names = getattr(real, "__all__", dir(real)) if wanted == "*" else wanted.split()
        for name in names:
            if name.startswith("_") or not callable(getattr(real, name, None)):
                continue
            for how, arguments in (("one", "3"), ("many", "3, 'a', 5, 6, 7, 8, 9, 10, 11, 12, 13, 14")):
                yield f"{module}.{name} {how}", looping(f"{module}.{name}({arguments})", f"import {module}")


_FILE = 'f = open("x.txt", "w")\nf.write("line\\n" * 2000)\nf.close()\nf = open("x.txt")\n'
FURTHER: Final[dict[str, str]] = {
    "movel out of reach": "movel([2.0, 0, 0.3, 3.14, 0, 0])",
    "inverse kinematics, near": f"get_inverse_kin({POSE}, {JOINTS})",
    "forward kinematics": f"get_forward_kin({JOINTS})",
    "open nothing": 'open("nosuch")',
    "open and close": 'open("y.txt", "w").close()',
    "readline": _FILE + "f.readline() or f.seek(0)",
    "readlines": _FILE + "f.seek(0) or f.readlines()",
    "read(1)": _FILE + "f.read(1) or f.seek(0)",
    "write and flush": 'f = open("z.txt", "w")\nf.write("x") and f.flush()',
    "listdir": 'import os\nos.listdir(".")',
    "message of 50 kB": 'textmsg("x" * 50000)',
    "message of 1 MB": 'textmsg("x" * 1000000)',
    "print of 1 MB": 'print("x" * 1000000)',
    "popup of 1 MB": 'popup("x" * 1000000, "t", False, False, blocking=False)',
    "warning of 1 MB": 'set_tcp(["x" * 1000000])',
    "send of one byte": 'socket_open("127.0.0.1", 9, "s")\nsocket_send_byte(1, "s")',
    "re": 'import re\nre.match("(", "x")',
    "sleep": "sleep(-1)",
    "popup with wrong arguments": "popup(1, 2, 3, 4, 5, 6, 7)",
    "start of threads": "start_thread(lambda: None, ())",
    "eval": 'eval("1 +")',
    "eval of globals": 'eval("[n for n in range(10)]")',
    "import of nothing": "import nosuch",
    "string times": '"x" * 10000000',
    "sorted big": "many = list(range(200000, 0, -1))\nsorted(many)",
    "power": "pow(3, 20000)",
    "sum": "sum(range(300000))",
    "list copy": "many = [0] * 300000\nlist(many)",
    "set": "many = list(range(100000))\nset(many)",
    "replace": 'text = "ab" * 200000\ntext.replace("a", "cc")',
    "one call without end, sum": "sync()\nsync()\nsum(range(10 ** 11))",
    "one call without end, re": "import re\nsync()\nsync()\nre.match('(a*)*b', 'a' * 40)",
    "five threads of refused moves": """def job():
  def one():
    while True:
      try:
        movel([2.0, 0, 0.3, 3.14, 0, 0])
      except Exception:
        pass
      end
    end
  end
  for n in range(5):
    start_thread(one, ())
  end
  one()
end
""",
    "clean-up without end": """def job():
  def deep(n):
    try:
      if n > 0:
        deep(n - 1)
      end
      while True:
        pass
      end
    finally:
      while True:
        get_steptime()
      end
    end
  end
  deep(200)
end
""",
    "recursion with finally": """def job():
  def deep(n):
    try:
      deep(n + 1)
    finally:
      n = n + 1
    end
  end
  while True:
    try:
      deep(0)
    except Exception:
      pass
    end
  end
end
""",
    "generator that is closed": """def job():
  def counting():
    try:
      while True:
        yield 1
      end
    finally:
      pass
    end
  end
  while True:
    g = counting()
    next(g)
    g.close()
  end
end
""",
    "polling": """def job():
  n = 0
  while True:
    if get_standard_digital_in(0):
      n = n + 1
    end
  end
end
""",
    "one pass a tick, for comparison": "def job():\n  while True:\n    sync()\n  end\nend\n",
    "a plain loop": "def job():\n  while True:\n    pass\n  end\nend\n",
}
