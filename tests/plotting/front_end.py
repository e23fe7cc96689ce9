"""A front end of one line in place of the built one, and the recordings in its pages."""

import re
from base64 import b64decode

from elitescript import page as built
from tests.conversation.test_recording import read

TEMPLATE = '<title>@@title@@</title><script type="text/plain" id="recording">@@recording@@</script><p>end</p>'


def pretend_built(folder, monkeypatch):
    """Let the front end be built, in a folder."""
    front = folder / "built"
    front.mkdir()
    (front / built.STUDIO).write_text("<p>")
    (front / built.RECORDED).write_text(TEMPLATE)
    (front / built.SWEEP).write_text(TEMPLATE)
    monkeypatch.setattr("elitescript.page._BUILT", front)


def pretend_not_built(folder, monkeypatch):
    """Let the front end not be built."""
    monkeypatch.setattr("elitescript.page._BUILT", folder / "not built")


def recordings_of(path):
    """Return the runs that a page holds."""
    return read(b64decode(re.search(r'id="recording">(.*?)</script>', path.read_text(encoding="utf-8"))[1]))
