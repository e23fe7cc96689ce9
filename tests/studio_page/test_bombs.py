"""Descriptions of arms that are bombs, through a real studio and a real browser: the page says why, and stays alive."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest
from playwright.sync_api import expect

from tests.studio.page_client import studio

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.slow

JOINTS: Final = (
    ("0 0 0.1625", "0 0 0"),
    ("0 0 0", "1.5707963267948966 0 0"),
    ("-0.427 0 0", "0 0 0"),
    ("-0.3905 0 0.1475", "0 0 0"),
    ("0 -0.0965 0", "1.5707963267948966 0 0"),
    ("0 0.092 0", "-1.5707963267948966 0 0"),
)
GOOD_STL: Final = bytes(80) + struct.pack("<I12fH", 1, *([0.0] * 3), 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0)


def urdf(visual: str, extra: str = "") -> str:
    links = "".join(f'<link name="l{n}"><visual><geometry>{visual}</geometry></visual></link>' for n in range(7))
    joints = "".join(
        f'<joint name="j{n}" type="revolute"><parent link="l{n}"/><child link="l{n + 1}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 0 1"/></joint>'
        for n, (xyz, rpy) in enumerate(JOINTS)
    )
    return f"<robot name='bomb'>{links}{joints}{extra}</robot>"


def mesh(name: str) -> str:
    return urdf(f'<mesh filename="{name}"/>')


def twice(count: int) -> str:
    """Return a chain in which each link hangs on two joints: two to the power of `count` ways."""
    links = "".join(f'<link name="x{n}"/>' for n in range(count))
    return links + "".join(
        f'<joint name="{side}{n}" type="fixed"><parent link="{f"x{n - 1}" if n else "l6"}"/>'
        f'<child link="x{n}"/></joint>'
        for n in range(count)
        for side in "ab"
    )


BOX: Final = '<box size="0.1 0.1 0.1"/>'
COLLADA: Final = (
    "<COLLADA><library_nodes>"
    + "".join(f'<node id="n{n}">{f"""<instance_node url="#n{n + 1}"/>""" * 3}</node>' for n in range(60))
    + '</library_nodes><library_visual_scenes><visual_scene id="z"><node><instance_node url="#n0"/></node>'
    '</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#z"/></scene></COLLADA>'
)

BOMBS: Final[dict[str, tuple[str, dict[str, bytes], str]]] = {
    "claims": (mesh("a.stl"), {"a.stl": bytes(80) + b"\xff" * 4 + bytes(50)}, "4294967295 triangles"),
    "large": (mesh("a.stl"), {"a.stl": bytes(33 << 20)}, "bytes; at most"),
    "facets": (mesh("a.stl"), {"a.stl": b"solid " + b"facet " * 5_000_000}, "has no triangles"),
    "triangles": (mesh("a.stl"), {"a.stl": bytes(80) + struct.pack("<I", 600_000) + bytes(30_000_000)}, "1,000,000"),
    "nodes": (mesh("a.dae"), {"a.dae": COLLADA.encode()}, "nodes"),
    "comments": (mesh("a.dae"), {"a.dae": b"<!-- >" * 5_000_000}, "is missing"),
    "ways": (urdf(BOX, twice(60)), {}, "hangs on two joints"),
    "deep": ("<robot>" * 200_000, {}, "inside of each other"),
    "shapes": (urdf(f"{BOX}</geometry></visual><visual><geometry>" * 3000 + BOX), {}, "at most 1000 are drawn"),
    "cut": (mesh("a.stl"), {"a.stl": GOOD_STL[:-1]}, "which are 134 bytes; it has 133"),
    "none": (mesh("a.stl"), {}, "there is no file"),
    "good": (mesh("a.stl"), {"a.stl": GOOD_STL}, ""),
}


@pytest.mark.timeout(180)
@pytest.mark.parametrize("name", BOMBS)
def test_the_page_says_why_and_goes_on(context: Callable[..., Page], tmp_path: Path, name: str) -> None:
    text, files, why = BOMBS[name]
    (tmp_path / "arm.urdf").write_text(text)
    for file, data in files.items():
        (tmp_path / file).write_bytes(data)
    program = tmp_path / "a.script"
    program.write_text("movej([0.1, -1.57, -1.57, -1.57, 1.57, 0])\n")
    with studio(program, "--urdf", tmp_path / "arm.urdf", state=tmp_path / "state") as address:
        page = context()
        page.set_default_timeout(60_000)
        page.goto(address)
        fault = page.locator(".robot-view .fault")
        if why:
            expect(fault).to_contain_text(why, timeout=60_000)
        # The page takes a text, runs it, and draws.
        page.get_by_role("textbox", name="Program text").click()
        page.keyboard.press("Control+End")
        page.keyboard.type("sleep(1)\n")
        expect(page.locator(".state")).to_contain_text("finished in 1.", timeout=60_000)
        assert page.get_by_role("region", name="Robot", exact=True).get_attribute("data-joints")
        if not why:
            expect(fault).to_have_count(0)
