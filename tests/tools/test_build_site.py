"""The sources of the site: links lead to where pages are there, every page has its place, every example its section."""

from __future__ import annotations

from pathlib import Path

import pytest

from tools import build_site
from tools.pages import ROOT
from tools.record_golden import programs

PLACES = build_site.site_pages()


@pytest.fixture(autouse=True)
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(build_site, "SOURCE", tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("name", "text", "wanted"),
    [
        ("docs/how-to/a.md", "[x](../reference/safety.md#limits)", "[x](../reference/safety.md#limits)"),
        ("docs/how-to/a.md", "[x](../../examples/circles.script)", "[x](examples/circles.md)"),
        ("docs/how-to/a.md", "[x](../../examples)", "[x](examples.md)"),
        ("docs/how-to/a.md", "[x](../../tests/spec/time.md)", "[x](../reference/language/time.md)"),
        ("docs/how-to/a.md", "[x](https://example.org/a.md) [y](#here)", "[x](https://example.org/a.md) [y](#here)"),
        ("docs/how-to/a.md", "`[x](../../examples)`", "`[x](../../examples)`"),
        ("ARCHITECTURE.md", "[x](docs/index.md) [y](README.md)", "[x](../index.md) [y](../index.md)"),
        ("docs/explanation/a.md", "![x](figures/belt.svg)", "![x](figures/belt.svg)"),
    ],
)
def test_links_lead_to_places_of_the_site(name: str, text: str, wanted: str) -> None:
    places = PLACES | {"docs/how-to/a.md": "how-to/a.md", "docs/explanation/a.md": "explanation/a.md"}
    assert build_site.site_text(name, text, places) == wanted


def test_a_file_that_is_no_page_goes_with_the_site(source: Path) -> None:
    text = build_site.site_text("docs/how-to/python.md", "[x](../../examples/insertion.toml)", PLACES)
    assert text == "[x](../files/examples/insertion.toml)"
    assert (source / "files/examples/insertion.toml").read_bytes() == (ROOT / "examples/insertion.toml").read_bytes()


@pytest.mark.parametrize(
    ("target", "message"),
    [
        ("nowhere.md", r"docs/index.md:3: nowhere.md: there is no such file"),
        ("../src", r"docs/index.md:3: ../src: a folder without a page"),
        ("../editors/vscode/README.md", r"docs/index.md:3: .*: a page that is not on the site"),
    ],
)
def test_a_link_without_a_place_is_refused(target: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        build_site.site_text("docs/index.md", f"# A\n\n[x]({target})\n", PLACES)


def test_the_title_of_a_block_becomes_its_caption() -> None:
    text = build_site.site_text("CONTRIBUTING.md", 'a\n\n```python title="b.py"\nc\n```\n', PLACES)
    assert text == "a\n\n```{code-block} python\n:caption: b.py\n\nc\n```\n"


def test_an_index_gets_its_contents_by_section() -> None:
    text = "# A\n\n[One](motion.md)\n\n## More\n\n[Two](math.md), [again](motion.md), [above](../signals.md)\n"
    wanted = "\n```{toctree}\n:hidden:\n\nOne <motion.md>\n```\n"
    wanted += "\n```{toctree}\n:hidden:\n:caption: More\n\nTwo <math.md>\n```\n"
    assert build_site.site_text("docs/reference/commands/index.md", text, PLACES) == text + wanted


@pytest.mark.parametrize("name", [name for name in PLACES if name.endswith(".md")])
def test_every_page_can_be_put_on_the_site(name: str) -> None:
    build_site.site_text(name, (ROOT / name).read_text(encoding="utf-8"), PLACES)


def test_every_example_has_a_section_that_says_what_to_look_at() -> None:
    sections = build_site.example_sections((ROOT / "docs" / build_site.EXAMPLES).read_text(encoding="utf-8"))
    assert set(sections) == {program.stem for program in programs()}
    assert [name for name, text in sections.items() if "**Look at**" not in text] == []


def test_the_page_of_an_example_has_its_call_plot_program_and_files() -> None:
    page = build_site.example_page(ROOT / "examples" / "plc_handshake.script", "What it shows.\n")
    assert "elitescript run examples/plc_handshake.script --world examples/plc_handshake.toml" in page
    assert 'src="plc_handshake.plot.html"' in page
    assert "What it shows." in page
    for name in ("plc_handshake.script", "plc_handshake.toml", "plc_handshake.py"):
        assert f":caption: {name}" in page
        assert (ROOT / "examples" / name).read_text(encoding="utf-8").rstrip() in page


def test_the_plot_of_an_example_is_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(build_site, "BUILD", tmp_path)
    build_site.draw_plot(ROOT / "examples" / "error_handling.script")
    assert "error_handling.script" in (tmp_path / "extra/how-to/examples/error_handling.plot.html").read_text("utf-8")
