"""Write `docs/images/plot.png`, the picture of a plot page in docs/how-to/run.md: `make picture`.

The page is the one that `elitescript plot` writes of an example, shown by a headless Chromium (any recent `chromium` or
`google-chrome`; `CHROMIUM=...` names it) with the cursor in the middle of the run. Its colours are rounded to 5 bits
per channel, which halves the size of the file.
"""

from __future__ import annotations

import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path
from typing import Final

from tools import browser

ROOT = Path(__file__).resolve().parent.parent
PICTURE: Final = ROOT / "docs" / "images" / "plot.png"
EXAMPLE: Final = ROOT / "examples" / "camera_picking.script"
WORLD: Final = ROOT / "examples" / "camera_picking.toml"
WIDTH, HEIGHT = 1280, 860
"""Size of the window, px."""
AT_S: Final = "20.1 s"
"""Time that is shown; the arm carries a part then."""
LARGEST: Final = 200_000
"""Size limit of the file, bytes."""
SETTLED_MS: Final = 3000
"""Until the picture is drawn finely, where there is no graphics card."""
_SIGNATURE: Final = b"\x89PNG\r\n\x1a\n"


def main() -> int:
    """Write the picture; return 0, or 2 with a message if there is no browser."""
    if browser.found() is None:
        print(browser.NOT_FOUND, file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder, "plot.html")
        plot = [sys.executable, "-m", "elitescript", "plot", str(EXAMPLE), "--world", str(WORLD), "-o", str(page)]
        subprocess.run(plot, check=True, stdout=subprocess.DEVNULL)
        picture = reduced(_shot(page))
    if len(picture) > LARGEST:
        print(f"the picture has {len(picture)} bytes; at most {LARGEST} are wanted", file=sys.stderr)
        return 2
    PICTURE.parent.mkdir(exist_ok=True)
    PICTURE.write_bytes(picture)
    print(f"{PICTURE.relative_to(ROOT)}: {len(picture) // 1000} kB")
    return 0


def _shot(page: Path) -> bytes:
    """Return a picture of a page as PNG."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        chromium = browser.started(driver)
        view = chromium.new_page(viewport={"width": WIDTH, "height": HEIGHT}, reduced_motion="reduce")
        view.goto(page.as_uri())
        field = view.get_by_role("region", name="Time line").get_by_role("textbox").first
        field.fill(AT_S)
        field.press("Enter")
        view.mouse.move(0, 0)
        view.wait_for_timeout(SETTLED_MS)
        picture = view.screenshot()
        chromium.close()
    return picture


def reduced(png: bytes) -> bytes:
    """Return the same picture with 5 bits of each channel, which compresses to half the size.

    Args:
        png: an RGB picture of 8 bits per channel, not interlaced, as Chromium writes it.

    Raises:
        ValueError: the picture has another format.
    """
    width, height, rows = _decoded(png)
    rounded = bytes(min(255, (value + 4) & 0x1F8) for value in range(256))
    lines = b"".join(b"\0" + row.translate(rounded) for row in rows)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(lines, 9)), (b"IEND", b""))
    return _SIGNATURE + b"".join(_chunk(name, data) for name, data in chunks)


def _chunk(name: bytes, data: bytes) -> bytes:
    """Return one chunk of a PNG file: length, name, data, checksum (PNG specification, section 5.3)."""
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def _decoded(png: bytes) -> tuple[int, int, list[bytes]]:
    """Return width, height and the rows of a picture, with the filters of its lines undone (section 9.2)."""
    if not png.startswith(_SIGNATURE):
        raise ValueError("not a PNG file")
    place, data, header = len(_SIGNATURE), b"", b""
    while place < len(png):
        (length,) = struct.unpack_from(">I", png, place)
        name, body = png[place + 4 : place + 8], png[place + 8 : place + 8 + length]
        header = body if name == b"IHDR" else header
        data += body if name == b"IDAT" else b""
        place += 12 + length
    width, height, *form = struct.unpack(">IIBBBBB", header)
    if form != [8, 2, 0, 0, 0]:
        raise ValueError(f"not an RGB picture of 8 bits per channel: {form}")
    raw, stride = zlib.decompress(data), 3 * width
    rows: list[bytes] = []
    above = bytearray(stride)
    for start in range(0, len(raw), stride + 1):
        kind, row = raw[start], bytearray(raw[start + 1 : start + 1 + stride])
        for i in range(stride):
            left, corner = (row[i - 3], above[i - 3]) if i >= 3 else (0, 0)
            row[i] = (row[i] + _predicted(kind, left, above[i], corner)) & 0xFF
        rows.append(bytes(row))
        above = row
    return width, height, rows


def _predicted(kind: int, left: int, above: int, corner: int) -> int:
    """Return what a filter of a line takes from the neighbours."""
    if kind == 4:
        distances = (abs(above - corner), abs(left - corner), abs(left + above - 2 * corner))
        return (left, above, corner)[distances.index(min(distances))]
    return (0, left, above, (left + above) // 2)[kind]


if __name__ == "__main__":
    sys.exit(main())
