"""Keeps what a session hears in MCAP files: channels for viewers, and the files of a rotation, each readable alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from pathlib import Path
from typing import Any, Final

from elitescript.client.rtsi_messages import OutputLayout
from elitescript.errors import UsageError
from elitescript.extras import require
from elitescript.paths import MOVED, REMOVED
from elitescript.protocol.binary import Number
from elitescript.recorder import channels
from elitescript.recorder.channels import CHANGES, DASHBOARD, EVENTS, PRIMARY, SLOW
from elitescript.recorder.facts import CLOCK, CONNECTED, STATES
from elitescript.recorder.mcap_file import files_of, rotated
from elitescript.recorder.protobuf import RowLayout
from elitescript.recorder.sinks import StorageError
from elitescript.recorder.writing import RecordingFile
from elitescript.records import record

_VIEW_NS: Final = round(1e9 / channels.VIEW_HZ)
LOSSES_MAX: Final = 3
"""Files that others may remove or truncate, one after the other, before the recording ends."""
_STANDING: Final = frozenset({CONNECTED, CLOCK})
"""Types of events that hold on, and that a further file begins with."""
_SEVERITIES: Final = ("info", "warning", "error", "fatal")
"""Levels of a robot error."""


@record
class Rotation:
    """When the next file begins; None for never."""

    size: int | None = None
    """Bytes."""
    age_s: float | None = None


class McapSink:
    """Writes one file after the other; the first is made when the first thing is heard.

    Args:
        path: of the first file.
        about: what holds for the whole recording, as texts: `host` and others.
        attachments: files of the user, by name.
        rotation: when the next file begins.
        say: takes what people should know, a line each.

    Attributes:
        rows: that were written.
        files: number of files.
        rows_lost: those of `rows` whose files others have removed or truncated.
        losses: what was lost of files that others have removed or truncated meanwhile, in words.

    Raises:
        UsageError: the extra is missing, a file of this recording exists already, or the folder does not.
    """

    def __init__(
        self,
        path: Path,
        about: Mapping[str, str],
        attachments: Mapping[str, bytes] | None = None,
        rotation: Rotation | None = None,
        say: Callable[[str], None] = lambda text: None,
    ) -> None:
        require("mcap")
        if not path.name:
            raise UsageError(f"{path} is no name of a file")
        if not path.parent.is_dir():
            raise UsageError(f"{path}: there is no folder {path.parent}")
        for taken in files_of(path):
            if taken.exists():
                raise UsageError(f"{taken} exists already; a recording is never written over")
        self.path = path
        self.rows = 0
        self.files = 0
        self.losses: list[str] = []
        self.rows_lost = 0
        self._say = say
        self._moved: Path | None = None
        """The file that was said to be moved."""
        self._rows_before = 0
        """Rows that were written when the file began."""
        self._sizes = 0
        self._about = dict(about)
        self._attachments = dict(attachments or {})
        self._rotation = rotation or Rotation()
        self._file: RecordingFile | None = None
        self._file_since_ns = 0
        self._layout: OutputLayout | None = None
        self._packed: RowLayout | None = None
        self._over = ""
        """Why nothing more is written; empty while all is well."""
        self._view: dict[str, Any] = {}
        self._next_view_ns = 0
        self._time_ns = 0
        """Of the controller, of the newest row."""
        self._standing: dict[tuple[str, str], dict[str, Any]] = {}
        """The newest of each kind of message that a further file begins with."""

    def add_attachment(self, name: str, data: bytes, role: str) -> None:
        """Add a file before the recording begins; `role` is a fact, such as `program`."""
        self._attachments[name] = data
        self._about[role] = name

    @property
    def size(self) -> int:
        """Bytes of all files."""
        return self._sizes + (self._file.size if self._file is not None else 0)

    # ---------------------------------------------------------------- what a session hands over

    def begin_rows(self, layout: OutputLayout) -> None:
        """See `Sink`."""
        self._layout = layout
        self._packed = RowLayout(channels.row_fields(layout.names, layout.types))
        self._view = {name: layout.getter(name) for name in _VIEWED if name in layout.names}
        if self._file is not None:
            self._file.begin_rows(self._packed)

    def row(self, t: float, flat: tuple[Number, ...], arrived_ns: int) -> None:
        """See `Sink`."""
        self._time_ns = time_ns = round(t * 1e9)
        file = self._open(arrived_ns)
        try:
            file.row(flat[1:], arrived_ns, time_ns)
            if arrived_ns >= self._next_view_ns:
                self._next_view_ns = max(self._next_view_ns + _VIEW_NS, arrived_ns)
                self._show(file, flat, arrived_ns)
        except OSError as error:
            self._give_up(error)
        self.rows += 1

    def message(self, channel: str, data: Mapping[str, Any], arrived_ns: int) -> None:
        """See `Sink`."""
        file = self._open(arrived_ns)
        self._remember(channel, data)
        try:
            file.message(channel, data, arrived_ns, self._time_ns)
            if channel == EVENTS:
                for name, values in _metadata_of(data).items():
                    file.note(name, values)
            line = _log_of(channel, data, arrived_ns)
            if line is not None:
                file.message(channels.LOG, line, arrived_ns, self._time_ns)
        except OSError as error:
            self._give_up(error)

    def tick(self, now_ns: int) -> None:
        """See `Sink`: flush, and begin the next file if it is time."""
        file = self._file
        if file is None:
            return
        try:
            file.flush()
            if self._is_lost(file):
                self._open(now_ns)
                return
            rotation = self._rotation
            is_large = rotation.size is not None and file.size >= rotation.size
            is_old = rotation.age_s is not None and now_ns - self._file_since_ns >= rotation.age_s * 1e9
            if is_large or is_old:
                self._finish(file)
                self._open(now_ns)
        except OSError as error:
            self._give_up(error)

    def close(self) -> None:
        """Write the index of the last file.

        Raises:
            StorageError: there is no room for it; the file can be read without.
        """
        file = self._file
        if file is not None:
            try:
                file.flush()
                if not self._is_lost(file):
                    self._finish(file)
            except OSError as error:
                self._give_up(error)

    def _is_lost(self, file: RecordingFile) -> bool:
        """Return whether others have removed or changed the file, which was flushed; then it is left as it is.

        Raises:
            StorageError: that has happened too often.
        """
        fate = file.fate()
        if not fate:
            return False
        if fate == MOVED:
            if self._moved != file.path:
                self._moved = file.path
                self._say(f"{file.path} {fate} while it was written; it goes on where it is")
            return False
        rows = self.rows - self._rows_before
        self.rows_lost += rows
        rest = "" if fate == REMOVED else ", but for what can be read of it"
        self.losses.append(f"{file.path} {fate}: its {rows:,} row{'s' if rows != 1 else ''} are lost{rest}")
        file.abandon()
        self._file = None
        if len(self.losses) >= LOSSES_MAX:
            self._over = f"{self.losses[-1]}; so it was {LOSSES_MAX} times, and nothing more is recorded"
            raise StorageError(self._over)
        self._say(f"{self.losses[-1]}; {rotated(self.path, self.files)} goes on")
        return True

    # ---------------------------------------------------------------- files

    def _open(self, now_ns: int) -> RecordingFile:
        """Return the file that is written to, a new one if there is none."""
        if self._file is not None:
            return self._file
        if self._over:
            raise StorageError(self._over)
        path = rotated(self.path, self.files) if self.files else self.path
        if not self.files:
            self._about["begin_ns"] = str(now_ns)
        try:
            file = self._file = RecordingFile(path, {**self._about, "file": str(self.files)})
        except UsageError as error:
            if not self.files:
                raise
            self._over = f"a further file cannot be begun: {error}"
            raise StorageError(self._over) from error
        self.files += 1
        self._rows_before = self.rows
        self._file_since_ns = now_ns
        for name, data in self._attachments.items():
            file.attach(name, data, now_ns)
        if self._packed is not None:
            file.begin_rows(self._packed)
        for (channel, _), said in self._standing.items():
            if channel not in (CHANGES, SLOW):
                said = {**said, "repeated": True}
            file.message(channel, said, now_ns, self._time_ns)
        # So that there is hardly a moment in which a file is there that cannot be read.
        file.flush()
        return file

    def _finish(self, file: RecordingFile) -> None:
        file.close()
        self._sizes += file.size
        self._file = None

    def _give_up(self, error: OSError) -> None:
        """Leave what there is.

        Raises:
            StorageError: always.
        """
        path = self.path
        if self._file is not None:
            path = self._file.path
            self._file.abandon()
            self._file = None
        self._over = f"{path}: {error.strerror or error}; what was written before, up to the last second, can be read"
        raise StorageError(self._over) from error

    def _remember(self, channel: str, data: Mapping[str, Any]) -> None:
        if channel in (CHANGES, SLOW):
            self._standing.setdefault((channel, ""), {}).update(data)
        elif channel == DASHBOARD:
            self._standing[channel, str(data.get("question"))] = dict(data)
        elif (channel == PRIMARY and data["type"] in STATES) or (channel == EVENTS and data["type"] in _STANDING):
            self._standing[channel, f"{data['type']} {data.get('port', '')}"] = dict(data)

    # ---------------------------------------------------------------- for viewers

    def _show(self, file: RecordingFile, flat: tuple[Number, ...], arrived_ns: int) -> None:
        """Write what viewers show of a row: joints and the place of the TCP."""
        view = self._view
        if _JOINTS in view:
            joints = [view[name](flat) if name in view else (0.0,) * 6 for name in (_JOINTS, _SPEEDS, _TORQUES)]
            file.message(channels.JOINT_STATES, channels.joint_states(arrived_ns, *joints), arrived_ns, self._time_ns)
        if _POSE in view:
            pose = view[_POSE](flat)
            if not all(map(isfinite, pose)):
                return
            for channel, made in (
                (channels.TCP, channels.pose_in_frame(arrived_ns, pose)),
                (channels.FRAMES, channels.frame_transforms(arrived_ns, pose)),
            ):
                file.message(channel, made, arrived_ns, self._time_ns)


_JOINTS, _SPEEDS, _TORQUES, _POSE = _VIEWED = (
    "actual_joint_positions",
    "actual_joint_speeds",
    "actual_joint_torques",
    "actual_TCP_pose",
)


def _metadata_of(event: Mapping[str, Any]) -> dict[str, dict[str, str]]:
    """Return the metadata records that tell other tools the same as an event: version, recipes, clock."""
    if event["type"] == CLOCK:
        return {"clock": {"offset_s": f"{event['offset_s']:.6f}", "meaning": "UTC less the time of the controller"}}
    if event["type"] == CONNECTED and "recipes" in event:
        recipes = {channel: ",".join(names) for channel, names in event["recipes"].items()}
        return {"controller": {"version": str(event["version"]), **recipes}}
    return {}


def _log_of(channel: str, data: Mapping[str, Any], time_ns: int) -> dict[str, Any] | None:
    """Return what a viewer's log shows of a message; None for nothing."""
    kind = data.get("type", "")
    if channel == EVENTS:
        level = "warning" if kind in ("lost", "gap", "repeated", "restart") else "info"
        rest = " ".join(f"{name}={value}" for name, value in data.items() if isinstance(value, str | float | int))
        return channels.log_line(time_ns, level, rest, "recorder")
    if channel != PRIMARY or "text" not in data:
        return None
    level = "info"
    if kind == "script exception":
        level = "error"
    elif kind == "robot error":
        number = data.get("level")
        level = _SEVERITIES[number] if isinstance(number, int) and 0 <= number < len(_SEVERITIES) else "warning"
    text = ": ".join(part for part in (str(data.get("title", "")), str(data["text"])) if part)
    return channels.log_line(time_ns, level, text, kind, int(data.get("line", 0)))
