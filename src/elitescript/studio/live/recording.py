"""A recording of a run, or a page of it, from a run of its own in a worker process."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Mapping
from pathlib import Path, PurePath
from typing import Any

from elitescript.conversation import describe
from elitescript.errors import ElitescriptError, ProgramError
from elitescript.plotting.conversation import packed
from elitescript.plotting.page import BYTES_MAX, page
from elitescript.plotting.recorder import RunRecorder
from elitescript.plotting.recording import Recording
from elitescript.plotting.sampling import Sampling
from elitescript.plotting.trace_reader import SUFFIXES, trace_of
from elitescript.studio.live.jobs import PreparedJob, job_of
from elitescript.studio.live.link import Link


def record_run(link: Link, request: Mapping[str, Any], jail: Callable[[], None]) -> None:
    """Run a program from begin to end, or read a trace, and send what was recorded.

    Args:
        link: to the engine.
        request: `job`, `ask`, `form`, `until_s`.
        jail: called before the text is compiled.
    """
    ask = request["ask"]
    try:
        found = _recording(request, jail)
    except ProgramError as error:
        link.send(describe.refused("; ".join(map(str, error.problems[:3])), ask))
    except ElitescriptError as error:
        link.send(describe.refused(str(error), ask))
    else:
        if request["form"] == "page":
            link.send(describe.recorded(ask, page(found)))
        else:
            link.send(describe.recorded(ask, b64encode(packed([found], BYTES_MAX)[0]).decode()))


def _recording(request: Mapping[str, Any], jail: Callable[[], None]) -> Recording:
    job = job_of(request["job"])
    robot = PreparedJob(job).robot()
    jail()
    name = PurePath(job.name).name
    if PurePath(name).suffix in SUFFIXES:
        return Recording(name, robot.model, trace_of(Path(name), job.text))
    source = job.source
    unit = robot.compile(source)
    recorder = RunRecorder(robot, Sampling())
    trace, until_s = recorder.sampling, request["until_s"]
    run = robot.run(unit, presets=job.presets, until_s=until_s, trace=trace, watch=recorder.watch)
    return recorder.recording(name, robot, source, run)
