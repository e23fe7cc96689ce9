"""Which requests are answered, and what refuses the others, in the order of the checks."""

from __future__ import annotations

import pytest

from elitescript.studio.admission import Request, hosts_of, new_token, refusal

PORT = 8123
TOKEN = "aB3_-" * 8
HOST = f"127.0.0.1:{PORT}"
PUBLIC = {"/studio.js"}


def status(
    target: str, hosts: tuple[str, ...] = (HOST,), origins: tuple[str, ...] = (), method: str = "GET", port: int = PORT
) -> int | None:
    found = refusal(Request(method, target, hosts, origins), port, TOKEN, PUBLIC)
    return None if found is None else found.status


@pytest.mark.parametrize("host", [HOST, f"localhost:{PORT}"])
def test_the_page_and_its_socket_are_answered(host: str) -> None:
    assert status(f"/?token={TOKEN}", (host,)) is None
    assert status(f"/?language=zh&token={TOKEN}", (host,)) is None
    assert status(f"/socket?token={TOKEN}", (host,), (f"http://{host}",)) is None
    assert status("/studio.js", (host,)) is None


@pytest.mark.parametrize(
    "hosts",
    [
        (),
        ("",),
        ("127.0.0.1",),
        ("localhost",),
        (f"127.0.0.1:{PORT + 1}",),
        (f"evil.example:{PORT}",),
        (f"127.0.0.1.evil.example:{PORT}",),
        (f"127.0.0.2:{PORT}",),
        (f"0.0.0.0:{PORT}",),
        (f"[::1]:{PORT}",),
        (f" {HOST}",),
        (HOST, HOST),
        (HOST, f"evil.example:{PORT}"),
    ],
)
def test_another_host_is_refused_before_the_token_is_looked_at(hosts: tuple[str, ...]) -> None:
    assert status(f"/?token={TOKEN}", hosts) == 421
    assert status("/", hosts) == 421
    assert status("/studio.js", hosts) == 421
    assert status(f"/socket?token={TOKEN}", hosts, ("http://evil.example",)) == 421


@pytest.mark.parametrize(
    "query",
    [
        "",
        "?",
        "?token",
        "?token=",
        f"?token={TOKEN[:-1]}",
        f"?token={TOKEN}x",
        f"?token={TOKEN.lower()}",
        f"?Token={TOKEN}",
        f"?token=%61{TOKEN[1:]}",
        f"?token={TOKEN}%00",
        f"?token={TOKEN}&token={TOKEN}",
        f"?token=x&token={TOKEN}",
        f"?xtoken={TOKEN}",
        f"?token= {TOKEN}",
        f"#token={TOKEN}",
        "?token=\u00e9",
        "?token=\ud800",
    ],
)
def test_a_missing_or_other_token_is_refused(query: str) -> None:
    assert status(f"/{query}") == 403
    assert status(f"/socket{query}", origins=(f"http://{HOST}",)) == 403
    assert status(f"/no-such-page{query}") == 403


@pytest.mark.parametrize(
    "origins",
    [
        (),
        ("null",),
        ("",),
        (f"https://{HOST}",),
        (f"http://{HOST}/",),
        (f"http://localhost:{PORT}",),
        (f"http://127.0.0.1:{PORT + 1}",),
        ("http://evil.example",),
        (f"http://{HOST}", f"http://{HOST}"),
        (f"http://{HOST} http://evil.example",),
        (f"HTTP://{HOST}",),
    ],
)
def test_a_socket_of_another_page_is_refused(origins: tuple[str, ...]) -> None:
    assert status(f"/socket?token={TOKEN}", origins=origins) == 403


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "HEAD", "OPTIONS", "get"])
def test_only_get_is_answered(method: str) -> None:
    assert status(f"/?token={TOKEN}", method=method) == 405
    assert status("/studio.js", method=method) == 405


@pytest.mark.parametrize(
    "path",
    [
        "/..%2fstudio.js",
        "/../studio.js",
        "/%2e%2e/x",
        "//studio.js",
        "/studio.js/",
        "/STUDIO.JS",
        "studio.js",
        "*",
        "/%2f",
    ],
)
def test_a_path_has_one_spelling(path: str) -> None:
    assert status(path) == 403
    assert status(f"{path}?token={TOKEN}") == 404


def test_browsers_leave_out_the_usual_port() -> None:
    assert status(f"/socket?token={TOKEN}", ("127.0.0.1",), ("http://127.0.0.1",), port=80) is None
    assert hosts_of(80) == ("127.0.0.1:80", "localhost:80", "127.0.0.1", "localhost")


def test_tokens_are_long_and_differ() -> None:
    made = {new_token() for _ in range(100)}
    assert len(made) == 100
    assert all(len(token) == 43 and token.replace("-", "").replace("_", "").isalnum() for token in made)
