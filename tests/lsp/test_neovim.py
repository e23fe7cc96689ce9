"""The page about editors, tried: Neovim with the Lua that stands there."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "how-to" / "editors.md"
PROGRAM = "def cell():\n  height = 0.2\n  movej([0, -1.5, 0, -1.57, 0, 0], v=1.0)\n  textmesg(height)\nend\n"


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("nvim") is None, reason="Neovim is not installed")
def test_the_lua_of_the_page(tmp_path):
    [lua] = re.findall(r"```lua\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    (tmp_path / "init.lua").write_text(lua, encoding="utf-8")
    (tmp_path / "cell.script").write_text(PROGRAM, encoding="utf-8")
    (tmp_path / "elitescript").write_text(f'#!/bin/sh\nexec {sys.executable} -m elitescript "$@"\n', encoding="utf-8")
    (tmp_path / "elitescript").chmod(0o755)
    seen = tmp_path / "seen.json"
    subprocess.run(
        ["nvim", "--headless", "-n", "-u", "init.lua", "-S", str(Path(__file__).with_name("journey.lua"))],
        cwd=tmp_path,
        stdin=subprocess.DEVNULL,
        check=True,
        timeout=60,
        env={
            **os.environ,
            "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}",
            "PROGRAM": str(tmp_path / "cell.script"),
            "SEEN": str(seen),
            "XDG_STATE_HOME": str(tmp_path),
            "XDG_CACHE_HOME": str(tmp_path),
        },
    )
    found = json.loads(seen.read_text(encoding="utf-8"))
    assert "failed" not in found
    assert found["filetype"] == "elitescript"
    assert found["finding"] == ["E301", 3, 2]
    assert "movej" in found["hover"]
    assert found["completion"] == "textmsg"
    assert found["text"] == [
        "def cell():",
        "  high = 0.2",
        "  movej([0, -1.5, 0, -1.57, 0, 0], v=1.0)",
        "  textmsg(high)",
        "end",
    ]
