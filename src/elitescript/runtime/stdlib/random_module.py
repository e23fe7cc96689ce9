"""`random` for scripts: every generator is seeded, so every run draws the same numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final

from elitescript.runtime.stdlib.loader import real

_METHODS: Final = (
    "betavariate choice choices expovariate gammavariate gauss getrandbits getstate lognormvariate normalvariate"
    " paretovariate randbytes randint random randrange sample setstate shuffle triangular uniform vonmisesvariate"
    " weibullvariate"
)


def new_generator(seed: int) -> Any:
    """Return a seeded generator: `random.Random`."""
    return real("random").Random(seed)


def random_names(generator: Any, sequence_class: Callable[[], Any]) -> dict[str, Any]:
    """Return the public names of `random` for one program.

    Args:
        generator: draws for the functions of the module, and seeds generators that get no seed.
        sequence_class: returns the program's own `collections.abc.Sequence`, which the installed module does not know.
    """
    base = type(generator)

    def known(population: Any) -> Any:
        is_own = not isinstance(population, Sequence) and isinstance(population, sequence_class())
        return tuple(population) if is_own else population

    class Random(base):  # type: ignore[misc, valid-type]
        """A generator of the program's own."""

        def __init__(self, seed: Any = None) -> None:
            super().__init__(generator.getrandbits(64) if seed is None else seed)

        def seed(self, a: Any = None, version: int = 2) -> None:
            """Begin a sequence; without a seed, one that the run's seed decides."""
            super().seed(generator.getrandbits(64) if a is None else a, version)

        def sample(self, population: Any, k: Any, *, counts: Any = None) -> list[Any]:
            """Choose k elements of a sequence, each at most once."""
            return super().sample(known(population), k, counts=counts)  # type: ignore[no-any-return]

    Random.__module__ = "random"
    Random.__qualname__ = "Random"

    def seed(a: Any = None, version: int = 2) -> None:
        """Begin a sequence; without a seed, one that the run's seed decides."""
        generator.seed(generator.getrandbits(64) if a is None else a, version)

    def sample(population: Any, k: Any, *, counts: Any = None) -> Any:
        """Choose k elements of a sequence, each at most once."""
        return generator.sample(known(population), k, counts=counts)

    methods = {name: getattr(generator, name) for name in _METHODS.split()}
    return {**methods, "Random": Random, "sample": sample, "seed": seed}
