"""Counts what the programs of a process run, in a `Recorder`. Implements `runtime.probe.Probe`."""

from __future__ import annotations

from elitescript.coverage.recording import Recorder
from elitescript.language.compiler import CompiledUnit
from elitescript.language.hooks import HITS
from elitescript.language.options import LINE, Options
from elitescript.language.probes import HITS_PROBES
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import Alarm, Event, SafetyModeChanged, TaskStateChanged
from elitescript.records import replace
