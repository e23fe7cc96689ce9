"""The codec of everything that goes between a serving process and its child, and into a journal."""

from __future__ import annotations

from elitescript.controller.contact import ContactConfig, Plane
from elitescript.controller.modes import PowerTimes
from elitescript.controller.safety_limits import SafetyBounds, SafetyLimits, SafetyPlane, ToolDirection
from elitescript.kernel.config import KernelConfig
from elitescript.messages.codec import Codec


def full_codec() -> Codec:
    """Messages of the waist and configurations."""
    return Codec(KernelConfig, PowerTimes, ContactConfig, Plane, SafetyLimits, SafetyBounds, SafetyPlane, ToolDirection)
