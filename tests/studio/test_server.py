"""The port, over real sockets: what it answers, what it refuses, and what hostile clients cannot do."""

from __future__ import annotations

import asyncio
import json
from base64 import b64encode
from collections.abc import Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

from elitescript import page
from elitescript.studio import server
from elitescript.studio.outbox import Outbox
from elitescript.studio.server import Door


class Echo:
    """A conversation that sends back what it is sent."""

    def __init__(self, outbox: Outbox) -> None:
        self.outbox = outbox
        self.is_closed = False

    async def take(self, text: str | bytes) -> None:
        message = json.loads(text)
        if message == "flood":
            for number in range(300):
                self.outbox.put(bytes(60_000))
                self.outbox.put({"type": "progress", "t": number})
            self.outbox.put({"type": "events", "list": ["last"]})
        elif message == "fail":
            raise ZeroDivisionError("a mistake of ours")
        else:
            self.outbox.put({"type": "echo", "of": message})

    async def close(self) -> None:
        self.is_closed = True


class Port:
    """An open door with pages that echo."""

    def __init__(self) -> None:
        self.pages: list[Echo] = []
        self.door = Door(self.begin)

    async def begin(self, outbox: Outbox) -> Echo:
        self.pages.append(Echo(outbox))
        return self.pages[-1]

    @property
    def host(self) -> str:
        return f"127.0.0.1:{self.door.port}"

    @property
    def query(self) -> str:
        return self.door.address.partition("?")[2]

    async def raw(self, data: bytes) -> bytes:
        """Send bytes; return everything that comes until the end."""
        reader, writer = await asyncio.open_connection("127.0.0.1", self.door.port)
        writer.write(data)
        try:
            return await asyncio.wait_for(reader.read(), 10.0)
        except ConnectionError:
            return b""
        finally:
            writer.close()

    async def get(self, target: str, host: str | None = None, method: str = "GET") -> tuple[int, dict[str, str], bytes]:
        """Return status, headers and body of an answer."""
        data = await self.raw(f"{method} {target} HTTP/1.1\r\nHost: {host or self.host}\r\n\r\n".encode())
        head, _, body = data.partition(b"\r\n\r\n")
        first, *rows = head.decode().split("\r\n")
        return int(first.split()[1]), dict(row.split(": ", 1) for row in rows), body

    def page(self, **given: Any) -> Any:
        origin = given.pop("origin", f"http://{self.host}")
        query = given.pop("query", self.query)
        settings = {"compression": None, "max_size": None, "proxy": None, "open_timeout": 5.0, **given}
        return connect(f"ws://{self.host}/socket?{query}", origin=origin, **settings)


@pytest.fixture(autouse=True)
def built(tmp_path: Path, monkeypatch) -> Iterator[None]:
    folder = tmp_path / "built"
    folder.mkdir()
    (folder / "studio.html").write_text("<!doctype html><title>Größe</title>", encoding="utf-8")
    (folder / "recorded.html").write_text("recorded")
    (folder / "studio.js").write_text("let a = 1;")
    (folder / "studio.css").write_text("p { }")
    (folder / "THIRD_PARTY.txt").write_text("MIT")
    (tmp_path / "secret.txt").write_text("secret")
    (folder / "link.txt").symlink_to(tmp_path / "secret.txt")
    monkeypatch.setattr(page, "_BUILT", folder)
    yield


@asynccontextmanager
async def opened() -> Any:
    port = Port()
    await port.door.open(0)
    try:
        yield port
    finally:
        await port.door.close()


def run(steps: Callable[[Port], Awaitable[None]]) -> Port:
    async def go() -> Port:
        async with opened() as port:
            await steps(port)
        return port

    made: Port = asyncio.run(go())
    return made


async def said(socket: ClientConnection, message: Any) -> Any:
    await socket.send(json.dumps(message))
    return json.loads(await asyncio.wait_for(socket.recv(), 5.0))


class TestPlainRequests:
    def test_the_page_and_its_files(self) -> None:
        async def steps(port: Port) -> None:
            status, headers, body = await port.get(f"/?{port.query}")
            assert (status, body.decode()) == (200, "<!doctype html><title>Größe</title>")
            assert headers["Content-Type"] == "text/html; charset=utf-8"
            for name, kind, text in (
                ("studio.js", "text/javascript", b"let a = 1;"),
                ("studio.css", "text/css", b"p { }"),
                ("THIRD_PARTY.txt", "text/plain", b"MIT"),
            ):
                status, headers, body = await port.get(f"/{name}")
                assert (status, headers["Content-Type"], body) == (200, f"{kind}; charset=utf-8", text)

        run(steps)

    def test_every_answer_has_the_headers_of_safety(self) -> None:
        async def steps(port: Port) -> None:
            answers = [
                await port.get(f"/?{port.query}"),
                await port.get("/studio.js"),
                await port.get("/"),
                await port.get("/", host="evil.example"),
                await port.get(f"/socket?{port.query}"),
                await port.get("/studio.js", method="POST"),
                await port.get(f"/no?{port.query}"),
            ]
            assert [answer[0] for answer in answers] == [200, 200, 403, 421, 403, 405, 404]
            policies = [headers["Content-Security-Policy"] for _, headers, _ in answers]
            code = answers[2][2].decode().partition("<script>")[2].partition("</script>")[0]
            digest = b64encode(sha256(code.encode()).digest()).decode()
            assert policies.pop(2) == (
                f"default-src 'none'; script-src 'sha256-{digest}'; base-uri 'none'; form-action 'none'; "
                "frame-ancestors 'none'"
            )
            assert set(policies) == {
                "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src data: blob:; "
                "connect-src 'self'; worker-src 'self' blob:; base-uri 'none'; form-action 'none'; "
                "frame-ancestors 'none'"
            }
            for _, headers, _ in answers:
                assert headers["X-Content-Type-Options"] == "nosniff"
                assert headers["Referrer-Policy"] == "no-referrer"
                assert headers["Cross-Origin-Opener-Policy"] == "same-origin"
                assert headers["Cache-Control"] == "no-store"
                assert not [name for name in headers if name.lower().startswith(("access-control", "server", "set-"))]

        run(steps)

    def test_only_built_files_are_given_away(self) -> None:
        async def steps(port: Port) -> None:
            for path in (
                "/..%2fsecret.txt",
                "/../secret.txt",
                "/%2e%2e/secret.txt",
                "//secret.txt",
                "/built/studio.js",
                "/studio.html",
                "/recorded.html",
                "/link.txt/..",
                "http://127.0.0.1/studio.js",
            ):
                assert (await port.get(path))[0] == 403
                assert (await port.get(f"{path}?{port.query}"))[0] == 404

        run(steps)

    @pytest.mark.parametrize(
        "data",
        [
            b"\r\n\r\n",
            b"GET\r\n\r\n",
            b"GET / HTTP/2\r\n\r\n",
            b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
            b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 1000 + b"\r\n",
            b"GET /" + b"x" * 100_000 + b" HTTP/1.1\r\n\r\n",
            b"GET / HTTP/1.1\r\nHost: \xff\r\n\r\n",
            b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 9\r\n\r\nxxxxxxxxx",
            b"GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
        ],
    )
    def test_what_is_no_request_ends_its_connection_alone(self, data: bytes) -> None:
        async def steps(port: Port) -> None:
            async with port.page() as socket:
                assert b" 200 " not in await port.raw(data + b"\r\n\r\n")
                assert await said(socket, 1) == {"type": "echo", "of": 1}

        run(steps)


class TestTicket:
    def test_it_leads_to_the_page_once(self) -> None:
        async def steps(port: Port) -> None:
            target = port.door.ticket_address().removeprefix(f"http://{port.host}")
            assert port.query not in target
            assert (await port.get(f"{target}x"))[0] == 403
            assert (await port.get(target.replace("/?", "/socket?")))[0] == 403
            status, headers, _ = await port.get(target)
            assert (status, headers["Location"]) == (303, f"/?{port.query}")
            assert (await port.get(target))[0] == 403

        run(steps)


class TestPages:
    @pytest.mark.parametrize(
        "given",
        [
            {"origin": None},
            {"origin": "null"},
            {"origin": "http://evil.example"},
            {"query": ""},
            {"query": "token=x"},
            {"additional_headers": {"Host": "evil.example"}},
        ],
    )
    def test_strangers_do_not_connect(self, given: dict[str, Any]) -> None:
        async def steps(port: Port) -> None:
            with pytest.raises(InvalidStatus) as refused:
                async with port.page(**given):
                    pass
            assert refused.value.response.status_code == (421 if "additional_headers" in given else 403)

        assert run(steps).pages == []

    def test_pages_talk_each_for_itself(self) -> None:
        async def steps(port: Port) -> None:
            async with port.page() as one, port.page() as two:
                assert await said(one, "a") == {"type": "echo", "of": "a"}
                assert await said(two, "b") == {"type": "echo", "of": "b"}
            assert len(port.pages) == 2

        assert all(echo.is_closed for echo in run(steps).pages)

    def test_a_message_that_is_too_long_ends_its_page_alone(self, monkeypatch) -> None:
        monkeypatch.setattr(server, "MESSAGE_BYTES_MAX", 10_000)

        async def steps(port: Port) -> None:
            async with port.page() as one, port.page() as two:
                fits = "x" * (server.MESSAGE_BYTES_MAX - 2)
                assert (await said(one, fits))["of"] == fits
                with pytest.raises(ConnectionClosed) as closed:
                    await said(one, fits + "x")
                assert closed.value.rcvd is not None and closed.value.rcvd.code == 1009
                assert await said(two, 1) == {"type": "echo", "of": 1}

        run(steps)

    def test_a_page_that_does_not_read_holds_up_nobody_and_gets_the_newest(self) -> None:
        async def steps(port: Port) -> None:
            async with port.page(max_queue=1) as slow, port.page() as other:
                await slow.send(json.dumps("flood"))
                assert await said(other, 1) == {"type": "echo", "of": 1}
                rows, progress = 0, []
                while True:
                    data = await asyncio.wait_for(slow.recv(), 5.0)
                    if isinstance(data, bytes):
                        rows += 1
                        continue
                    message = json.loads(data)
                    if message["type"] == "events":
                        break
                    progress.append(message["t"])
                assert rows == 300
                assert progress[-1] == 299
                assert len(progress) < 290

        run(steps)

    def test_a_mistake_of_ours_ends_its_page_alone_and_is_printed(self, capsys) -> None:
        async def steps(port: Port) -> None:
            async with port.page() as one, port.page() as two:
                with pytest.raises(ConnectionClosed) as closed:
                    await said(one, "fail")
                assert closed.value.rcvd is not None and closed.value.rcvd.code == 1011
                assert await said(two, 1) == {"type": "echo", "of": 1}

        assert all(echo.is_closed for echo in run(steps).pages)
        assert "ZeroDivisionError: a mistake of ours" in capsys.readouterr().err

    def test_too_many_pages_are_refused(self, monkeypatch) -> None:
        monkeypatch.setattr(server, "PAGES_MAX", 1)

        async def steps(port: Port) -> None:
            async with port.page() as one:
                await said(one, 1)
                with pytest.raises(InvalidStatus) as refused:
                    async with port.page():
                        pass
                assert refused.value.response.status_code == 503
            async with port.page() as two:
                assert await said(two, 2) == {"type": "echo", "of": 2}

        run(steps)


class TestHangingClients:
    def test_they_are_cut_off(self, monkeypatch) -> None:
        monkeypatch.setattr(server, "OPENING_S", 0.05)

        async def steps(port: Port) -> None:
            assert b" 200 " not in await port.raw(b"GET / HTTP/1.1\r\nHost: ")

        run(steps)

    def test_a_flood_of_them_does_not_keep_the_page_out(self, monkeypatch) -> None:
        monkeypatch.setattr(server, "CONNECTIONS_MAX", 8)

        async def steps(port: Port) -> None:
            async with port.page() as first:
                assert await said(first, 1) == {"type": "echo", "of": 1}
                hanging = [await asyncio.open_connection("127.0.0.1", port.door.port) for _ in range(20)]
                for _, writer in hanging:
                    writer.write(b"GET /")
                assert (await port.get(f"/?{port.query}"))[0] == 200
                async with port.page() as second:
                    assert await said(second, 2) == {"type": "echo", "of": 2}
                assert await said(first, 3) == {"type": "echo", "of": 3}
                with suppress(ConnectionError):
                    # The oldest one was hung up on.
                    assert await asyncio.wait_for(hanging[0][0].read(), 5.0) == b""
                for _, writer in hanging:
                    writer.close()

        run(steps)

    def test_the_end_does_not_wait_for_them(self) -> None:
        async def steps(port: Port) -> None:
            _, writer = await asyncio.open_connection("127.0.0.1", port.door.port)
            writer.write(b"GET /")
            await asyncio.wait_for(port.door.close(), 5.0)
            writer.close()

        run(steps)
