"""Random programs that always end and log what they do."""

from __future__ import annotations

from random import Random

VALUES = [
    "a",
    "b",
    "len(b)",
    "[q * 2 for q in b if q > 1]",
    "{q: r for q in b for r in range(q)}",
    "sum(q for q in b)",
    "(lambda q: q + 1)(2)",
    "sorted(b, key=lambda q: -q)",
    "'{}-{}'.format(a, b)",
    "7",
    "a if b else 0",
    "f'{a!r:>5}'",
    "[*b, *range(2)]",
    "(z := 3) + z",
    "list(map(lambda q: (q, q), b))",
    "any(q for q in b if q == 2)",
]
DEEPEST = 4


def random_program(rng: Random) -> str:
    """A program named `job`."""
    rows = ["a = 3", "b = [1, 2, 3]", "c = d = 0", *_block(rng, 0)]
    return "\n".join(["def job():", *_indented(rows), "end", ""])


def _indented(rows: list[str]) -> list[str]:
    return [f"  {row}" for row in rows]


def _block(rng: Random, depth: int) -> list[str]:
    rows = []
    for _ in range(rng.randrange(1, 4)):
        rows += _statement(rng, depth)
    return rows


def _statement(rng: Random, depth: int) -> list[str]:
    simple = [_assignment, _log, _augmented]
    makers = simple if depth == DEEPEST else [*simple, _handler, _choice, _loop, _repetition, _function, _class, _with]
    return rng.choice(makers)(rng, depth)


def _closer(rng: Random) -> list[str]:
    return rng.choice([["end"], []])


def _assignment(rng: Random, depth: int) -> list[str]:
    return [f"{rng.choice('acd')} = {rng.choice(VALUES)}"]


def _log(rng: Random, depth: int) -> list[str]:
    return [f"textmsg({rng.choice(VALUES)})"]


def _augmented(rng: Random, depth: int) -> list[str]:
    return [f"{rng.choice('ab')} {rng.choice(['+=', '-=', '|='])} {rng.randrange(1, 3)}"]


def _handler(rng: Random, depth: int) -> list[str]:
    body = rng.choice(["1 / 0", "[][1]", "a = 4", "unknown", "int(b)", "raise ValueError(a)"])
    rows = ["try:", f"  {body}", *_indented(_block(rng, depth + 1))]
    rows += [f"except {rng.choice(['ZeroDivisionError', 'Exception', '(NameError, IndexError)'])} as e:"]
    rows += ["  textmsg(type(e).__name__)", "except:", "  textmsg('other')"]
    if rng.random() < 0.5:
        rows += ["finally:", *_indented(_block(rng, depth + 1))]
    return rows + _closer(rng)


def _choice(rng: Random, depth: int) -> list[str]:
    rows = [f"if {rng.choice(VALUES)}:", *_indented(_block(rng, depth + 1)), f"elif {rng.choice(VALUES)}:", "  pass"]
    return [*rows, "else:", *_indented(_block(rng, depth + 1)), *_closer(rng)]


def _loop(rng: Random, depth: int) -> list[str]:
    values = rng.choice(["range(3)", "[5, 6]", "(j for j in range(2))", "'xy'"])
    rows = [f"for i{depth} in {values}:", *_indented(_block(rng, depth + 1))]
    rows += rng.choice([[], ["  if a: continue"], ["  if a: break"], ["else:", "  textmsg('else')"]])
    return rows + _closer(rng)


def _repetition(rng: Random, depth: int) -> list[str]:
    name = f"n{depth}"
    rows = [f"{name} = 0", f"while {name} < {rng.randrange(4)}:", f"  {name} += 1"]
    return [*rows, *_indented(_block(rng, depth + 1)), *_closer(rng)]


def _function(rng: Random, depth: int) -> list[str]:
    name = f"f{depth}"
    ending, use = rng.choice(
        [
            ("return x", f"{name}()"),
            ("yield x", f"list({name}())"),
            ("return lambda y=x: y", f"{name}()()"),
            ("return [x for x in range(x)]", f"{name}(x=2)"),
        ]
    )
    rows = [f"def {name}(x={rng.randrange(9)}, *rest):", "  a = 0", "  b = [4]", "  c = d = 1"]
    return [*rows, *_indented(_block(rng, depth + 1)), f"  {ending}", *_closer(rng), f"textmsg({use})"]


def _class(rng: Random, depth: int) -> list[str]:
    rows = [
        "class Box:",
        "  size = [k for k in range(3)]",
        "  def __init__(self, v=2): self.__v = v",
        "  def get(self):",
    ]
    return [*rows, "    return [self.__v + k for k in self.size]", *_closer(rng), "textmsg(Box().get(), Box.__name__)"]


def _with(rng: Random, depth: int) -> list[str]:
    rows = ["class Guard:", "  def __enter__(self): return 1", "  def __exit__(self, *e):", "    textmsg('exit')"]
    rows += [f"    return {rng.choice(['True', 'False'])}", "with Guard() as w:"]
    return [*rows, *_indented(_block(rng, depth + 1)), *_closer(rng)]
