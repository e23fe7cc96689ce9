"""What one page sees of a controller: the conversation of `web/src/source/messages.ts` in mode "connected"."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any, Final

from elitescript import __version__
from elitescript.conversation import messages as asked
from elitescript.conversation.describe import hello, refused
from elitescript.errors import ElitescriptError, UsageError
from elitescript.studio.connected.commands import FAULTS
from elitescript.studio.connected.controller import ConnectedController
from elitescript.studio.connected.jogging import GAP_S

WAITING_MAX: Final = 20
"""Messages of a page that may wait for the controller's answers at a time."""

NOTHING_REPEATED: Final = "a controller shows what is now: it does not go back to a moment"

Send = Callable[[Mapping[str, Any] | bytes], None]


class ConnectedSource:
    """What one page talks to.

    Args:
        controller: the connections, which all pages share.
    """

    def __init__(self, controller: ConnectedController) -> None:
        self._controller = controller
        self._send: Send = _nowhere
        self._waiting: set[asyncio.Task[None]] = set()
        self._heard_s: float | None = None
        """Time of the loop of the last message of a button that is held; None if none is."""

    async def start(self, send: Send) -> None:
        """Send `hello`, `scene` and what is known; then every change.

        Args:
            send: takes messages, and frames of rows; does not block.
        """
        controller = self._controller
        self._send = send
        product, programs = f"elitescript {__version__}", controller.target.programs or None
        send(hello("connected", product, controller.abilities, controller.title, programs=programs))
        controller.join(send)

    async def take(self, message: asked.ToSource) -> None:
        """Do what the page asks for, or refuse it in words; messages that are not for a controller are left out.

        Returns before the controller has answered: the end of a jog or an emergency stop must not wait for it.
        """
        if isinstance(message, asked.Jog | asked.JogEnd | asked.Guiding | asked.Program) or _is_guiding(message):
            # These do not wait for the controller; and nothing is to move the arm for a page that has left meanwhile.
            await self._answer(message)
        elif len(self._waiting) < WAITING_MAX or _is_urgent(message):
            task = asyncio.create_task(self._answer(message))
            self._waiting.add(task)
            task.add_done_callback(self._waiting.discard)
        else:
            self._send(refused("the controller has not answered to what was asked for before", _ask_of(message)))

    async def _answer(self, message: asked.ToSource) -> None:
        ask = _ask_of(message)
        try:
            text = await self._obey(message)
        except ElitescriptError as error:
            self._send(refused(str(error), ask))
        else:
            if ask is not None and text is not None:
                self._send({"type": "done", "ask": ask, "text": text})

    async def _obey(self, message: asked.ToSource) -> str | None:
        """Do it; return what the page is answered, None for nothing."""
        controller = self._controller
        match message:
            case asked.Program():
                controller.know(message.text)
            case asked.Jog():
                self._jog(message)
            case asked.JogEnd():
                self._heard_s = None
                if controller.jogger is not None:
                    controller.jogger.release_jog(self)
            case asked.Guiding():
                if controller.jogger is not None:
                    controller.jogger.keep_guiding(self)
            case asked.Control(action="freedrive_on"):
                controller.check_guiding().guide(self)
                return "hand guiding"
            case asked.Control(action="freedrive_off"):
                controller.check_control()
                assert controller.jogger is not None
                controller.jogger.release(self)
                return "hand guiding has ended"
            case asked.Control():
                return await controller.press(message.action)
            case asked.SetSignal():
                return await controller.set_signal(message.name, message.value)
            case asked.Speed():
                return await controller.set_speed(message.fraction)
            case asked.Load():
                return await controller.load(message.program)
            case asked.SendProgram():
                return await controller.run_text(message.text)
            case asked.Fault():
                if not message.words or message.words[0] not in FAULTS:
                    raise UsageError(f"a fault is one of {', '.join(sorted(FAULTS))}")
                return await controller.order(message.words[0], message.words[1:])
            case asked.Detail() | asked.Seek() | asked.Step():
                raise UsageError(NOTHING_REPEATED)
            case _:
                pass
        return None

    def _jog(self, message: asked.Jog) -> None:
        """Move, or refuse it once: a button that is held must not move the arm later, when the reason is gone."""
        held_back = self._controller.held_back
        now_s = asyncio.get_running_loop().time()
        last_s, self._heard_s = self._heard_s, now_s
        if last_s is None:
            held_back.discard(self)
        elif self in held_back:
            return
        try:
            if last_s is not None and now_s - last_s > GAP_S:
                raise UsageError(f"nothing was heard of the page for {GAP_S:g} s; release the button first")
            jogger = self._controller.check_moves()
            jogger.jog(self, message.frame, message.axis, message.direction, message.speed)
        except UsageError:
            held_back.add(self)
            raise

    async def close(self) -> None:
        """Stop what the page has begun: jogging, hand guiding."""
        if self._controller.jogger is not None:
            self._controller.jogger.release(self)
        self._controller.held_back.discard(self)
        self._controller.leave(self._send)
        self._send = _nowhere


def _is_urgent(message: asked.ToSource) -> bool:
    return isinstance(message, asked.Control) and message.action in ("emergency_stop", "stop", "power_off")


def _is_guiding(message: asked.ToSource) -> bool:
    return isinstance(message, asked.Control) and message.action in ("freedrive_on", "freedrive_off")


def _ask_of(message: asked.ToSource) -> int | None:
    return getattr(message, "ask", None)


def _nowhere(_message: Mapping[str, Any] | bytes) -> None:
    pass
