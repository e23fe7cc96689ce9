"""A recording held against the simulated robot."""

from elitescript.audit.auditing import Audit, audit
from elitescript.audit.motion import Tolerance

__all__ = ["Audit", "Tolerance", "audit"]
