"""Draws programs without commands: numbers, lists, loops, exceptions, functions that close over variables."""

from __future__ import annotations

import re
from random import Random

_SIGNS = ("<", "<=", ">", ">=", "==", "!=")


class Drawn:
    """Draws one program; `tick` is called in each turn of a loop and each function.

    Args:
        rng: draws.
    """

    def __init__(self, rng: Random) -> None:
        self.rng = rng
        self.names = ["a", "b", "c", "d"]
        self.lists = ["u", "v"]
        self.functions: list[str] = []
        self.loops = 0
        self.is_function = False

    def text(self) -> str:
        """Return the program."""
        rows = ["def f():"]
        rows += [f"  {name} = {self.rng.randint(-2, 3)}" for name in self.names]
        rows += [f"  {name} = [{self.rng.randint(0, 3)}, 2.5]" for name in self.lists]
        for number in range(self.rng.randint(0, 2)):
            rows += self._function(f"g{number}")
        return "\n".join([*rows, *self._block("  ", self.rng.randint(4, 9), 3), "end", ""])

    def _function(self, name: str) -> list[str]:
        outer, outer_functions = self.names, self.functions
        first, self.names = self.rng.choice(
            [("a = 0", ["x", "y", "a"]), ("nonlocal a, b", ["x", "y", "a", "b"]), ("own = c", ["x", "y", "own"])]
        )
        self.functions = self.rng.choice([outer_functions, [*outer_functions, name]])
        self.is_function = True
        body = self._block("    ", self.rng.randint(1, 4), 2)
        rows = [f"  def {name}(x, y):", f"    {first}", "    tick()", *body, f"    return {self.number()}", "  end"]
        self.is_function = False
        self.names, self.functions = outer, [*outer_functions, name]
        return rows

    def _choose(self, depth: int, *weighted: tuple[int, str]) -> str:
        """Return one of some templates; in it stand `@n`, `@l`, `@c` for expressions, `@v`, `@w` for variables."""
        template = self.rng.choices([text for _, text in weighted], [weight for weight, _ in weighted])[0]

        def made(found: re.Match[str]) -> str:
            if found[1] in "vw":
                return self.rng.choice(self.names if found[1] == "v" else self.lists)
            return {"n": self.number, "l": self.list, "c": self.condition}[found[1]](depth - 1)

        return re.sub("@([nlcvw])", made, template)

    def number(self, depth: int = 2) -> str:
        """Return an expression that is mostly a number."""
        literal = str(self.rng.choice([self.rng.randint(-3, 5), 0.5, -1.5, 1000.0]))
        if depth <= 0:
            return self.rng.choice([literal, self.rng.choice(self.names)])
        sign = self.rng.choice("+-*")
        calls = [(2, f"{self.rng.choice(self.functions)}(@n, @n)")] if self.functions else []
        return self._choose(
            depth,
            *((4, literal), (6, "@v"), (4, f"(@n {sign} @n)"), (1, "(@n // 2)"), (1, "(@n % 3)"), (1, "(@n / -2)")),
            *(
                (1, "abs(@n)"),
                (1, "len(@l)"),
                (2, "@w[0]"),
                (1, "@w[-1]"),
                (1, "max(@n, @n)"),
                (1, "min(@l)"),
                (1, "int(@n)"),
            ),
            *(
                (1, "(@n if @c else @n)"),
                (1, "round(@n)"),
                (1, "sum(@l)"),
                (1, "(@n and @n)"),
                (1, "(@n or @n)"),
                *calls,
            ),
        )

    def list(self, depth: int = 2) -> str:
        """Return an expression that is mostly a list."""
        if depth <= 0:
            return self.rng.choice(self.lists)
        return self._choose(
            depth,
            *(
                (6, "@w"),
                (1, "[]"),
                (2, "[@n]"),
                (2, "[@n, @n]"),
                (2, "(@l + @l)"),
                (1, "[x + 1 for x in @l]"),
                (1, "@w[1:]"),
            ),
            *(
                (1, "[x for x in @l if x > 0]"),
                (1, "list(range(3))"),
                (1, "sorted(@l)"),
                (1, "@w.copy()"),
                (1, "(@l * 2)"),
            ),
        )

    def condition(self, depth: int = 2) -> str:
        """Return a condition."""
        comparison = f"@n {self.rng.choice(_SIGNS)} @n"
        if depth <= 0:
            return self._choose(0, (1, comparison))
        return self._choose(
            depth,
            *((8, comparison), (1, "(@c and @c)"), (1, "(@c or @c)"), (1, "not @c"), (1, "@v"), (1, "len(@w) > 1")),
            *((1, "len(@w) == 2"), (1, "@v is None"), (1, "isinstance(@v, int)"), (1, "@n in @l"), (1, "0 < @n <= 2")),
        )

    def _block(self, indent: str, count: int, depth: int) -> list[str]:
        return [row for _ in range(count) for row in self._statement(indent, depth)]

    def _simple(self) -> str:
        sign, method = (
            self.rng.choice("+-*"),
            self.rng.choice(["append(@n)", "insert(0, @n)", "remove(@n)", "extend([@n])"]),
        )
        leaving = [(2, self.rng.choice(["break", "continue"]))] if self.loops else []
        leaving += [(1, "return @n")] if self.is_function else []
        return self._choose(
            2,
            *(
                (16, "@v = @n"),
                (1, "@v = None"),
                (1, "@v = 'go'"),
                (1, "@v = True"),
                (5, f"@v {sign}= @n"),
                (4, "@w = @l"),
            ),
            *(
                (4, f"@w.{method}"),
                (2, "@w[0] = @n"),
                (1, "@w[-1] = @n"),
                (1, "@w.pop()"),
                (1, "@v, @v = @n, @n"),
                (1, "@w += @l"),
            ),
            *((1, "del @w[0]"), (1, "raise ValueError(1)"), *leaving),
        )

    def _statement(self, indent: str, depth: int) -> list[str]:
        inner, kind = indent + "  ", self.rng.random()
        if depth <= 0 or kind < 0.6:
            return [indent + self._simple()]
        if kind < 0.75:
            rows = [f"{indent}if {self.condition()}:", *self._block(inner, 2, depth - 1)]
            if kind < 0.65:
                rows += [f"{indent}elif {self.condition()}:", *self._block(inner, 1, depth - 1)]
            return [*rows, f"{indent}else:", *self._block(inner, 1, depth - 1), f"{indent}end"]
        if kind < 0.9:
            heads = [f"while {self.condition()}:", f"for {self._choose(0, (1, '@v'))} in {self.list(1)}:"]
            head = self.rng.choice([*heads, f"for {self._choose(0, (1, '@v, @v'))} in enumerate({self.list(0)}):"])
            self.loops += 1
            body = self._block(inner, self.rng.randint(1, 3), depth - 1)
            self.loops -= 1
            return [indent + head, f"{inner}tick()", *body, f"{indent}end"]
        rows = [f"{indent}try:", *self._block(inner, 2, depth - 1)]
        if kind < 0.96:
            rows += [f"{indent}except Exception:", *self._block(inner, 1, depth - 1)]
        if kind > 0.94:
            # What leaves a loop or a function there would swallow the end of the test.
            loops, is_function, self.loops, self.is_function = self.loops, self.is_function, 0, False
            rows += [f"{indent}finally:", *self._block(inner, 1, depth - 1)]
            self.loops, self.is_function = loops, is_function
        return [*rows, f"{indent}end"]
