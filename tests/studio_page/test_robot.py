"""The drawn robot: the region says what is drawn, its path is a place in time, and it does without WebGL."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from tests.studio_page.conftest import Open
from tests.studio_page.fake_source import FakeSource, Play, joints

ON_THE_PATH = """() => {
  const canvas = document.querySelector("section[aria-label=Robot] canvas");
  const box = canvas.getBoundingClientRect();
  for (let y = Math.floor(box.bottom) - 1; y > box.top; y -= 3)
    for (let x = Math.ceil(box.left); x < box.right; x += 3) {
      canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: x, clientY: y, pointerType: "mouse" }));
      if (canvas.style.cursor === "pointer") return [x, y];
    }
}"""
"""The lowest place on the path in the view that is drawn, in whole pixels, as clicks have them; seen from the top, the
begin of the run."""

FROM_THE_TOP = """() => {
  const [x, y, z] = document.querySelector("section[aria-label=Robot]").dataset.camera.split(",").map(Number);
  return Math.hypot(x, y) < 0.7 * z;
}"""
"""Whether the view from the top is what was drawn last: the others look from one side, 45 degrees and more off."""

NO_WEBGL = """
const context = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...given) {
  return kind.startsWith("webgl") ? null : context.call(this, kind, ...given);
};
"""
"""As a browser whose driver is blocked."""

CANVAS = "document.querySelector('section[aria-label=Robot] canvas')"


def robot(page: Page):
    return page.get_by_role("region", name="Robot", exact=True)


DRAWN = """([t, joints]) => {
  const { time, joints: drawn } = document.querySelector("section[aria-label=Robot]").dataset;
  return Number(time) === t && drawn.split(",").every((joint, index) => Math.abs(Number(joint) - joints[index]) < 1e-9);
}"""


def wait_drawn(page: Page, t: float) -> None:
    """Wait until the region says this time and the joints of the source, which those between two rows are not."""
    page.wait_for_function(DRAWN, arg=[t, joints(t)])


def test_the_path_is_a_place_in_time(open_page: Open) -> None:
    page, source = open_page()
    expect(page.locator(".state")).to_contain_text("finished")
    page.get_by_role("slider", name="Time").focus()
    page.keyboard.press("End")
    wait_drawn(page, 4.0)
    picture = robot(page).get_by_role("img")
    expect(picture).to_have_attribute("aria-label", re.compile("^CS66 at 4.000 s: TCP at x "))
    assert not page.evaluate(FROM_THE_TOP)
    robot(page).get_by_role("button", name="Top", exact=True).click()
    # Pictures wait while keys come, so the view is another one for some time.
    page.wait_for_function(FROM_THE_TOP)
    x, y = page.evaluate(ON_THE_PATH)
    page.mouse.move(x, y)
    label = robot(page).locator(".labels .ghost")
    expect(label).to_have_text(re.compile(r"\d\.\d{3} s"))
    pointed = float(label.inner_text().removesuffix(" s"))
    expect(robot(page)).to_have_attribute("data-time", "4")
    page.mouse.click(x, y)
    t = source.wait("seek")["t"]
    assert t == pytest.approx(pointed, abs=0.0021)
    wait_drawn(page, t)
    robot(page).get_by_role("button", name="J3").click()
    expect(robot(page).locator(".labels .limit")).to_have_count(2)


@pytest.mark.parametrize("lose", [False, True], ids=["refused", "lost"])
def test_without_webgl_the_robot_is_drawn_flat(context: Callable[..., Page], lose: bool) -> None:
    with FakeSource(Play()) as source:
        page = context()
        if not lose:
            page.add_init_script(NO_WEBGL)
        page.goto(source.address)
        expect(page.locator(".state")).to_contain_text("finished")
        if lose:
            page.evaluate(f"{CANVAS}.getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()")
        expect(robot(page)).to_contain_text("This browser gives no WebGL")
        page.get_by_role("slider", name="Time").focus()
        page.keyboard.press("PageUp")
        wait_drawn(page, 1.0)
        assert page.evaluate(f"{CANVAS}.getContext('2d').getImageData(0, 0, 300, 200).data.some(Boolean)")
