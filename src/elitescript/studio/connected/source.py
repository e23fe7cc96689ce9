"""What one page sees of a controller: the conversation of `web/src/source/messages.ts` in mode "connected"."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from elitescript import __version__
from elitescript.conversation import messages as asked
from elitescript.conversation.describe import hello, refused
from elitescript.errors import ElitescriptError, UsageError
from elitescript.studio.connected.commands import FAULTS
from elitescript.studio.connected.controller import ConnectedController


Send = Callable[[Mapping[str, Any] | bytes], None]


class ConnectedSource:
    """What one page talks to.

    Args:
        controller: the connections, which all pages share.
        abilities: what the page can do besides, such as open and save files.
    """

    def __init__(self, controller: ConnectedController, abilities: Sequence[str] = ()) -> None:
        self._controller = controller
        self._abilities = tuple(abilities)
        self._send: Send = _nowhere

    async def start(self, send: Send) -> None:
        """Send `hello`, `scene` and what is known; then every change.

        Args:
            send: takes messages, and frames of rows; does not block.
        """
        controller = self._controller
        self._send = send
        product, programs = f"elitescript {__version__}", controller.target.programs or None
        abilities = (*controller.abilities, *self._abilities)
        send(hello("connected", product, abilities, controller.title, programs=programs))
        controller.join(send)

    async def take(self, message: asked.ToSource) -> None:
        """Do what the page asks for, or refuse it in words; messages that are not for a controller are left out."""
        ask = getattr(message, "ask", None)
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
            case asked.Jog():
                controller.check_moves().jog(self, message.frame, message.axis, message.direction, message.speed)
            case asked.JogEnd():
                if controller.jogger is not None:
                    controller.jogger.release(self)
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
            case _:
                pass
        return None

    async def close(self) -> None:
        """Stop what the page has begun: jogging, hand guiding."""
        if self._controller.jogger is not None:
            self._controller.jogger.release(self)
        self._controller.leave(self._send)


def _nowhere(_message: Mapping[str, Any] | bytes) -> None:
    pass
