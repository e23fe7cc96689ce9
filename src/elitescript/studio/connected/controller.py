"""The connections to one controller, shared by all pages: what comes from its ports, and what is sent to them."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Coroutine, Mapping, Sequence
from contextlib import suppress
from typing import Any, Final

from elitescript.client.connecting import BACKOFF_S, LinkError, keep_connected
from elitescript.client.dashboard import DashboardClient, dashboard_client
from elitescript.client.primary import PrimaryClient, primary_client
from elitescript.client.primary_messages import RobotState, RobotText
from elitescript.client.rtsi import rtsi_client
from elitescript.conversation import describe
from elitescript.conversation.limits import EventBudget, bounded, cut, cut_name
from elitescript.errors import ElitescriptError, PeerError, UsageError
from elitescript.messages.enums import RobotMode, TaskState
from elitescript.messages.signals import Value
from elitescript.protocol.binary import WireValue
from elitescript.protocol.primary.messages import KEY
from elitescript.protocol.primary.packets import CARTESIAN, CONFIGURATION
from elitescript.services.control.channel import exchange
from elitescript.studio.connected import commands
from elitescript.studio.connected.jogging import Jogger, end_of_range
from elitescript.studio.connected.picture import PICTURE_HZ, VARIABLES, Picture
from elitescript.studio.connected.reports import report_of
from elitescript.studio.connected.scene import scene_of
from elitescript.studio.connected.signals import REGISTERS, REGISTERS_HZ
from elitescript.studio.connected.target import Target
from elitescript.studio.connected.trail import Trail

ASK_S: Final = 1.0
"""Between two rounds of questions at the dashboard."""
GRACE_S: Final = 0.5
"""After which the primary port's states are shown where RTSI is not there."""
PROGRAM_S: Final = 3.0
"""Longest time for a program that was sent to be seen running."""
STOP_S: Final = 1.0
"""Longest time for the dashboard to take a stop; then the primary port gets it."""
CTL_S: Final = 10.0
"""Longest time for an answer of `ctl`, s."""
REPORTS_KEPT: Final = 500
GLOBALS_MAX: Final = 200
"""Variables that are asked for."""
GLOBAL_MAX: Final = 2000
"""Characters of the value of one."""
GUIDING_SINCE: Final = (2, 14)
"""Firmware that brought `freedrive_mode`."""

Message = dict[str, Any]
Take = Callable[[Mapping[str, Any] | bytes], None]


class ConnectedController:
    """Watches a controller, and commands it if it may.

    Args:
        target: which controller.
        backoff_s: pauses between attempts to connect.

    Attributes:
        picture: what is known of it.
        jogger: moves the arm for the pages; None without control.
    """

    def __init__(self, target: Target, backoff_s: tuple[float, ...] = BACKOFF_S) -> None:
        self.target = target
        self._backoff_s = backoff_s
        self.picture = Picture(f"{target.host}:{target.ports['primary']}")
        self._pages: list[Take] = []
        self._tasks: list[asyncio.Task[None]] = []
        self._trail = Trail()
        self._reports: deque[Message] = deque(maxlen=REPORTS_KEPT)
        self._fresh: list[Message] = []
        """Reports that pages have not got yet."""
        self._budget = EventBudget()
        self._left_out = 0, 0
        """Reports and bytes that pages know to be left out."""
        self._scene: Message | None = None
        self._scene_key: object = None
        self._configuration: dict[str, WireValue] | None = None
        self._primary: PrimaryClient | None = None
        self._dashboard: DashboardClient | None = None
        self._has_rtsi = False
        self._rtsi_ended_s = 0.0
        """Time of the loop."""
        self._pictured_s = 0.0
        """Time of the loop at which the last picture came."""
        self._takes_registers = True
        self._firmware: tuple[int, ...] = ()
        self._globals: tuple[str, ...] = ()
        """Variables that are asked for."""
        self._popups = 0
        self._said: dict[str, str] = {}
        self.held_back: set[object] = set()
        """Pages whose jogging was ended or refused: they have to release the button first."""
        self.jogger: Jogger | None = None
        if target.may_control:
            self.jogger = Jogger(
                target.host,
                target.ports["rtsi"],
                target.jog_register,
                send=self.send_script,
                halt=self._halt,
                task_state=lambda: self.picture.task_state,
                joint_at_end=self._joint_at_end,
                picture_age_s=lambda: asyncio.get_running_loop().time() - self._pictured_s,
                answer=lambda: self.picture.values.get(f"output_int_register{target.jog_register}"),
                ended=self._jog_ended,
            )

    # ---------------------------------------------------------------- beginning and end

    async def open(self) -> None:
        """Begin to connect; a controller that is not there is tried again and again."""
        self._rtsi_ended_s = asyncio.get_running_loop().time()
        sessions: list[tuple[str, Callable[[], Coroutine[Any, Any, None]]]] = [
            ("rtsi", self._watch_rtsi),
            ("primary", self._watch_primary),
            ("dashboard", self._watch_dashboard),
        ]
        if self.target.control_socket is not None:
            sessions.append(("ctl", self._watch_ctl))
        for name, session in sessions:
            self._tasks.append(
                asyncio.create_task(keep_connected(session, self._lost(name), self._backoff_s), name=name)
            )

    async def close(self) -> None:
        """Stop what was begun here, and hang up."""
        if self.jogger is not None:
            await self.jogger.close()
        for task in self._tasks:
            task.cancel()
        for task in self._tasks:
            with suppress(asyncio.CancelledError):
                await task

    def join(self, take: Take) -> None:
        """Give everything to one more page, beginning with what is known."""
        if self._scene is not None:
            take(self._scene)
        for message in self._trail.all():
            take(message)
        if self._reports:
            take(self._events(list(self._reports)))
        if self._left_out != (0, 0):
            take(describe.left_out(self._trail.run, self._budget))
        take(self._moment())
        for text in self._said.values():
            take(self._fault(text))
        self._pages.append(take)

    def leave(self, take: Take) -> None:
        """Give nothing more to a page."""
        if take in self._pages:
            self._pages.remove(take)

    @property
    def title(self) -> str:
        """Which robot at which address, and whether it can be commanded."""
        model = self.picture.model or self.target.robot
        return f"{model} at {self.picture.address}".strip() if model else self.picture.address

    @property
    def abilities(self) -> tuple[str, ...]:
        """What the page can do."""
        if not self.target.may_control:
            return ("live",)
        return ("live", "control", "signals", *(("faults",) if self.target.control_socket is not None else ()))

    # ---------------------------------------------------------------- what comes from the ports

    async def _watch_rtsi(self) -> None:
        target = self.target
        async with rtsi_client(target.host, target.ports["rtsi"]) as client:
            self._firmware = await client.negotiate()
            answers = (f"output_int_register{target.jog_register}",) if target.may_control else ()
            pictures = await client.set_up_outputs((*VARIABLES, *answers), PICTURE_HZ)
            if self._takes_registers:
                # A controller that ends the connection because of so many names is not asked again.
                self._takes_registers = False
                with suppress(PeerError):
                    await client.set_up_outputs(REGISTERS, REGISTERS_HZ)
                self._takes_registers = True
            await client.start()
            self.picture.firmware = ".".join(map(str, self._firmware))
            self._recovered("rtsi")
            try:
                while True:
                    found = await client.packages()
                    if not self._has_rtsi:
                        self._has_rtsi = True
                        self.picture.forget()
                    for layout, payload in found:
                        self.picture.take_package(layout.values(layout.flat(payload)))
                    # Of pictures that have waited the newest is now.
                    if any(layout is pictures for layout, _ in found):
                        self._publish()
            finally:
                self._has_rtsi = False
                self._rtsi_ended_s = asyncio.get_running_loop().time()

    async def _watch_primary(self) -> None:
        target = self.target
        async with primary_client(target.host, target.ports["primary"], may_command=target.may_control) as client:
            self._recovered("primary")
            self._primary = client
            try:
                while True:
                    for message in await client.messages():
                        if isinstance(message, RobotState):
                            self._take_state(message)
                        else:
                            self._take_report(message)
                    self._tell_reports()
            finally:
                self._primary = None

    def _take_state(self, state: RobotState) -> None:
        cartesian = state.part(CARTESIAN)
        offset = None if cartesian is None else cartesian["TCP offset"]
        configuration = state.parts.get(CONFIGURATION.number)
        key = (configuration, offset)
        if key != self._scene_key:
            self._scene_key = key
            self._configuration = state.part(CONFIGURATION)
            made = scene_of(self._configuration, offset if isinstance(offset, tuple) else None, self.target.robot)
            if made is not None and made != self._scene:
                self._scene = made
                self._tell(made)
        if not self._has_rtsi and asyncio.get_running_loop().time() - self._rtsi_ended_s > GRACE_S:
            self.picture.take_state(state)
            self._publish()

    def _take_report(self, message: RobotText) -> None:
        if message.kind == "popup":
            self._popups += 1
            values, texts = message.values, message.texts
            level = "error" if values.get("is error") else "warning" if values.get("is warning") else "info"
            title, text = texts.get("title", ""), texts.get("text", "")
            self.picture.popup = bounded({"title": title, "text": text, "level": level, "id": self._popups})
        if message.kind == KEY.name and message.texts.get("text") != commands.SENT_NAME:
            self.picture.line_offset = 0
        report = report_of(message, self.picture.time_s, self.picture.line_offset)
        if report is not None:
            self._reports.append(bounded(report))
            self._fresh += self._budget.take([report])

    def _tell_reports(self) -> None:
        """Tell the pages new reports, and how many they do not get."""
        if self._fresh:
            self._tell(self._events(self._fresh))
            self._fresh = []
        known = self._budget.events, self._budget.bytes
        if known != self._left_out:
            self._left_out = known
            self._tell(describe.left_out(self._trail.run, self._budget))
        if self._budget.events:
            self._trail.renew()

    async def _watch_dashboard(self) -> None:
        target, picture = self.target, self.picture
        async with dashboard_client(target.host, target.ports["dashboard"], may_command=target.may_control) as client:
            self._recovered("dashboard")
            self._dashboard = client
            try:
                picture.model = cut_name(await client.ask("robot -t"))
                picture.serial = cut_name(await client.ask("robot -s"))
                picture.firmware = picture.firmware or cut_name(await client.ask("version"))
                while True:
                    picture.program = cut_name((await client.ask("task")).partition("Relative path:")[2].strip())
                    # A controller without this command answers with an error: then it is not known to be local.
                    picture.is_remote = not (await client.ask("remoteControl -s")).strip().lower().endswith("off")
                    await self._ask_globals(client)
                    await asyncio.sleep(ASK_S)
            finally:
                self._dashboard = None

    async def _ask_globals(self, client: DashboardClient) -> None:
        values: dict[str, str] = {}
        for name in self._globals:
            found, colon, value = (await client.ask(f"variable -get {name}")).partition(":")
            if colon and found.strip() == name:
                values[cut_name(name)] = cut(value.strip(), GLOBAL_MAX)[0]
        self.picture.globals = values

    def know(self, text: str) -> None:
        """Take the text of a page's editor: the variables that it declares global are asked for."""
        self._globals = commands.globals_of(text)[:GLOBALS_MAX]

    async def _watch_ctl(self) -> None:
        while True:
            state = await self._ctl("state")
            text = str(state.get("result", {}).get("popup", ""))
            if not text:
                self.picture.popup = None
            elif self.picture.popup is None:
                self._popups += 1
                self.picture.popup = {"title": "", "text": text, "level": "info", "id": self._popups}
            await asyncio.sleep(0.5)

    def _publish(self) -> None:
        """Tell the pages the present picture."""
        picture = self.picture
        picture.link = "connected"
        self._pictured_s = asyncio.get_running_loop().time()
        picture.is_jogging = self.jogger is not None and self.jogger.is_active
        run = self._trail.run
        for message in self._trail.take(picture):
            self._tell(message)
        if self._trail.run > run > 0:
            self._budget, self._left_out, self._fresh = EventBudget(), (0, 0), []
            if self._reports:
                self._tell(self._events(self._budget.take(self._reports)))
        if picture.task_state is TaskState.STOPPED and self.target.control_socket is None:
            # Nothing says that a window was closed; without a program none is left.
            picture.popup = None
        self._tell(self._moment())

    def _moment(self) -> Message:
        return self.picture.message()

    def _events(self, reports: list[Message]) -> Message:
        return {"type": "events", "run": self._trail.run, "list": reports}

    def _tell(self, message: Message | bytes) -> None:
        for take in tuple(self._pages):
            take(message)

    def _lost(self, name: str) -> Callable[[str], None]:
        """Return what is called with the reason whenever a connection is lost or cannot be had."""

        def lost(text: str) -> None:
            if self._said.get(name) != text:
                self._said[name] = text
                self._tell(self._fault(text))
            if not self._has_rtsi and self._primary is None:
                self.picture.link = "lost" if self.picture.link != "connecting" else "connecting"
                self._tell(self._moment())

        return lost

    def _fault(self, text: str) -> Message:
        return describe.notice("error", f"{self.title}: {text}")

    def _recovered(self, name: str) -> None:
        if self._said.pop(name, None) is not None:
            self._tell({"type": "notice", "severity": "information", "text": f"{self.title}: {name} port connected"})

    # ---------------------------------------------------------------- what is sent to the ports

    def check_control(self) -> None:
        """Refuse to go on without control.

        Raises:
            UsageError: the studio was started without it.
        """
        if not self.target.may_control:
            raise UsageError("this studio only looks: start it with --control to command the controller")

    async def press(self, action: str) -> str:
        """Do what a button says; return the controller's words.

        Raises:
            ElitescriptError: it is refused, with the reason, or there is no connection.
        """
        self.check_control()
        if action in commands.CTL and self.target.control_socket is not None:
            verb, *words = commands.CTL[action]
            return await self.order(verb, words)
        if action == "emergency_stop":
            return await self._stop_over_the_network(*commands.STOPS)
        if action not in commands.DASHBOARD:
            raise UsageError(f"only a robot that is served on this computer has {action.replace('_', ' ')}")
        line, successes = commands.DASHBOARD[action]
        reply = await self._command(line, successes)
        if action == "close_popup":
            self.picture.popup = None
        elif action == "play" and self.picture.task_state is TaskState.STOPPED:
            self.picture.line_offset = 0
        return reply

    async def _command(self, line: str, successes: Sequence[str]) -> str:
        is_stop = line in commands.STOPS
        if not is_stop and (why := commands.refusal(line, self.picture)):
            raise UsageError(why)
        if is_stop and (self._dashboard is None or self._dashboard.is_busy):
            return await self._stop_over_the_network(line)
        if self._dashboard is None:
            raise LinkError("the dashboard port is not connected")
        reply = await self._dashboard.ask(line)
        if not reply.startswith(tuple(successes)):
            raise UsageError(f"the controller refuses: {reply}")
        return reply

    async def _stop_over_the_network(self, *lines: str) -> str:
        """Send commands of `STOPS` over connections that nothing else uses or holds up."""
        target = self.target
        try:
            async with (
                asyncio.timeout(STOP_S),
                dashboard_client(target.host, target.ports["dashboard"], may_command=True) as client,
            ):
                return ", ".join([await client.ask(line) for line in lines])
        except (ElitescriptError, TimeoutError) as error:
            # The primary port takes the same as plain commands.
            words = [commands.STOPS[line] for line in lines]
            await self.send_script("\n".join(words))
            why = str(error) or f"nothing came within {STOP_S:g} s"
            return f"{', '.join(words)}: sent to the primary port; the dashboard did not answer: {why}"

    async def _halt(self) -> None:
        """End the program of the controller.

        Raises:
            LinkError: no port takes it.
        """
        await self._stop_over_the_network("stop")

    async def order(self, verb: str, words: Sequence[str], values: dict[str, Value] | None = None) -> str:
        """Ask a robot on this computer by `ctl`; return its words.

        Raises:
            ElitescriptError: it is refused, with the reason, or there is no such robot.
        """
        self.check_control()
        if self.target.control_socket is None:
            raise UsageError("only a robot that is served on this computer can do that")
        answer = await self._ctl(verb, words, values)
        if not answer.get("ok"):
            raise UsageError(str(answer.get("error", "refused")))
        return str(answer.get("text", "done"))

    async def _ctl(self, verb: str, words: Sequence[str] = (), values: dict[str, Value] | None = None) -> Message:
        assert self.target.control_socket is not None
        try:
            async with asyncio.timeout(CTL_S):
                answer = await exchange(self.target.control_socket, verb, words, values)
        except TimeoutError:
            raise LinkError(f"ctl: no answer to {verb} within {CTL_S:g} s") from None
        except (UsageError, OSError, ValueError, RecursionError) as error:
            raise LinkError(f"ctl: {error}") from None
        if not isinstance(answer, dict):
            raise LinkError("ctl: the answer is no record")
        return answer

    async def set_speed(self, fraction: float) -> str:
        """Move the speed slider.

        Raises:
            ElitescriptError: see `press`.
        """
        self.check_control()
        percent = round(fraction * 100)
        reply = await self._command(f"speed -v {percent}", ("",))
        if "fail" in reply.lower():
            raise UsageError(f"the controller refuses: {reply}")
        return reply

    async def set_signal(self, name: str, value: Value) -> str:
        """Set an output; of a robot on this computer, any signal.

        Raises:
            ElitescriptError: see `press`.
        """
        self.check_control()
        if self.target.control_socket is not None:
            return await self.order("set", (), {name: value})
        await self.send_script(commands.output_program(name, value))
        return f"{name}={value}"

    async def load(self, program: str) -> str:
        """Load a task.

        Raises:
            ElitescriptError: see `press`.
        """
        self.check_control()
        if not program.isprintable():
            raise UsageError("the name of a program is one line")
        return await self._command(f"task -p {program}", ("Loaded task",))

    async def run_text(self, text: str) -> str:
        """Send a text as a program, and wait until it runs.

        Raises:
            ElitescriptError: it does not run; with what the controller says.
        """
        self.check_control()
        if why := commands.refusal("play", self.picture):
            raise UsageError(why)
        unit, offset = commands.unit_of(text)
        seen = len(self._reports)
        newest = self._reports[-1] if self._reports else None
        self.picture.line_offset = offset
        self.know(text)
        await self.send_script(unit)
        loop = asyncio.get_running_loop()
        end = loop.time() + PROGRAM_S
        while loop.time() < end:
            await asyncio.sleep(1.0 / PICTURE_HZ)
            fresh = (
                []
                if self._reports and self._reports[-1] is newest
                else list(self._reports)[min(seen, REPORTS_KEPT - 1) :]
            )
            for report in fresh:
                if report["type"] == "alarm":
                    raise UsageError(f"line {report['line']}: {report['text']}")
            if self.picture.task_state is not TaskState.STOPPED or any(map(_is_start, fresh)):
                return "the program runs on the controller"
        raise UsageError("the controller does not start the program; is it under remote control?")

    async def send_script(self, text: str) -> None:
        """Send a program to the primary port.

        Raises:
            LinkError: it is not connected.
            CommandError: there is no control.
        """
        if self._primary is None:
            raise LinkError("the primary port is not connected")
        await self._primary.send_script(text)

    # ---------------------------------------------------------------- moving the arm

    def check_moves(self) -> Jogger:
        """Return what moves the arm, if the state allows it.

        Raises:
            UsageError: it does not; says why.
        """
        self.check_control()
        assert self.jogger is not None
        picture = self.picture
        if picture.link != "connected":
            raise UsageError("the controller is not connected")
        if not picture.is_remote:
            raise UsageError("the robot is under local control; switch it to remote control first")
        if not picture.may_move:
            state = "RUNNING" if picture.robot_mode is not RobotMode.RUNNING else "NORMAL"
            raise UsageError(
                f"the arm cannot move: robot mode {picture.robot_mode.name}, safety {picture.safety_mode.name}; "
                f"it needs {state}"
            )
        if picture.task_state is not TaskState.STOPPED and not self.jogger.is_active:
            raise UsageError("a program runs or is paused; stop it first")
        return self.jogger

    def check_guiding(self) -> Jogger:
        """Return what lets a person guide the arm, if state and firmware allow it.

        Raises:
            UsageError: they do not; says why.
        """
        self.check_control()
        if self._firmware and self._firmware[:2] < GUIDING_SINCE:
            version = ".".join(map(str, GUIDING_SINCE))
            raise UsageError(f"firmware {self.picture.firmware} has no freedrive_mode; {version} brought it")
        return self.check_moves()

    def _jog_ended(self, owner: object, text: str) -> None:
        self.held_back.add(owner)
        self._tell({"type": "notice", "severity": "warning", "text": f"{self.title}: {text}"})

    def _joint_at_end(self, speeds: Sequence[float]) -> int:
        joints, scene = self.picture.joints, self._scene
        if joints is None or scene is None:
            return 0
        limits = scene["limits"]
        return end_of_range(joints, speeds, limits["position_min"], limits["position_max"])


def _is_start(report: Message) -> bool:
    return report["type"] == "task" and report.get("state") == "started"
