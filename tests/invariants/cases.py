"""How many cases a sweep tries: as many as `ELITESCRIPT_INVARIANTS` says, else few enough for `make test`."""

from __future__ import annotations

import os
from typing import Final

CASES: Final = int(os.environ.get("ELITESCRIPT_INVARIANTS", "20"))
