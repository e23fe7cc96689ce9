"""Random programs with scopes in scopes: few names, used in every way."""

from __future__ import annotations

from random import Random

_NAMES = ("a", "b", "c", "d")


def random_scopes(rng: Random) -> str:
    """A program that always compiles; it may fail when it runs."""
    rows = [f"{name} = {number}" for number, name in enumerate(_NAMES[: rng.randrange(1, 4)])]
    for _ in range(rng.randrange(2, 6)):
        rows += _statement(rng, 0, set())
    return "\n".join(["def job():", *(f"  {row}" for row in rows), "end", ""])


def _value(rng: Random) -> str:
    name, other = rng.choice(_NAMES), rng.choice(_NAMES)
    forms = ("{0}", "{0} + 1", "[{0} for {0} in (1, 2)]", "[{1} + {0} for {0} in (1, 2)]", "(lambda {0}: {0})({1})")
    more = (
        "[{0} for {1} in (3,) for {0} in ({1},)]",
        "f'{{{0}}} {{{1}}}'",
        "(lambda {0}=1: {0} + {1})()",
        "{{{0}: {1}}}",
    )
    return rng.choice(forms + more).format(name, other)


def _statement(rng: Random, depth: int, declared: set[str]) -> list[str]:
    name = rng.choice(_NAMES)
    kind = rng.randrange(9 if depth < 3 else 5)
    if kind == 0:
        return [f"{name} = {_value(rng)}"]
    if kind == 1:
        return [f"textmsg({_value(rng)})"]
    if kind == 2:
        return [f"for {name} in ({_value(rng)}, 2):", f"  textmsg({name})", "end"]
    if kind == 3:
        return ["try:", f"  textmsg({_value(rng)})", f"except Exception as {name}:", f"  textmsg({name})", "end"]
    if kind == 4:
        return [f"{name} = 1", f"{name} += 2"]
    if kind == 5:
        return _class(rng, depth)
    return _function(rng, depth)


def _function(rng: Random, depth: int) -> list[str]:
    name = rng.choice(("f", "g"))
    parameters = rng.sample(_NAMES, rng.randrange(3))
    rows = []
    free = [other for other in _NAMES if other not in parameters]
    if rng.random() < 0.4:
        rows.append(f"global {rng.choice(free)}")
    for _ in range(rng.randrange(1, 4)):
        rows += _statement(rng, depth + 1, set())
    if rng.random() < 0.2:
        rows.append(f"global {rng.choice(free)}")
    given = ", ".join(f"{parameter}={number}" for number, parameter in enumerate(parameters))
    header = f"def {name}({', '.join(parameters)}):"
    call = f"textmsg({name}({given}))"
    return [header, *(f"  {row}" for row in rows), f"  return {_value(rng)}", "end", call]


def _class(rng: Random, depth: int) -> list[str]:
    own, other = rng.sample(_NAMES, 2)
    return [
        "class K:",
        f"  {own} = {_value(rng)}",
        f"  def get(self, {other}=1):",
        f"    self.{own} = {_value(rng)}",
        f"    return self.{own}",
        "  end",
        "end",
        f"textmsg(K().get({other}=2), K.{own})",
    ]
