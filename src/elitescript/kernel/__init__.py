"""One robot as a function: inputs of a tick in, its output out."""

from __future__ import annotations

from elitescript.kernel.config import KernelConfig
from elitescript.kernel.kernel import Kernel

__all__ = ["Kernel", "KernelConfig"]
