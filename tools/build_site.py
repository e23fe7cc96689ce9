"""Build the site from docs/, the examples and the pages at the root: `make docs`.

The pages of the repository are plain Markdown that also reads well without a site. Here they are copied into
build/site/source with links that fit the site, a table of contents below each index, a page for each example with its
text and the plot of its run, and one with the data of the arms; then Sphinx builds build/site/html. A link that leads
nowhere fails the build.
"""

from __future__ import annotations

import os
import posixpath
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tools.pages import ROOT, Block, Page, read_page
from tools.record_golden import programs, settings

SETTINGS: Final = ROOT / "tools" / "site"
BUILD: Final = ROOT / "build" / "site"
SOURCE: Final = BUILD / "source"
HTML: Final = BUILD / "html"

EXAMPLES: Final = "how-to/examples.md"
MODELS: Final = "src/elitescript/models"
FOLDERS: Final = {
    "docs/reference": "reference/index.md",
    "examples": EXAMPLES,
    "tests/spec": "reference/language/index.md",
    MODELS: "reference/models.md",
}
"""The page to which a link to a folder leads."""

OTHER_PAGES: Final = {
    "ARCHITECTURE.md": "explanation/architecture.md",
    "CHANGELOG.md": "reference/changelog.md",
    "CONTRIBUTING.md": "explanation/contributing.md",
    "README.md": "index.md",
    "README.zh.md": "index.md",
    "tests/spec/README.md": "reference/language/index.md",
}
LANGUAGES: Final = {".script": "elitescript", ".toml": "toml", ".py": "python"}
ELSEWHERE: Final = ("http:", "https:", "mailto:")


def site_pages() -> dict[str, str]:
    """Map the pages of the repository to their places on the site, both as relative paths.

    The first page of the site is docs/index.md, to which links to README.md lead too.
    """
    places = dict(OTHER_PAGES)
    for path in (ROOT / "tests" / "spec").glob("*.md"):
        places.setdefault(f"tests/spec/{path.name}", f"reference/language/{path.name}")
    for path in (ROOT / "docs").rglob("*.md"):
        places[path.relative_to(ROOT).as_posix()] = path.relative_to(ROOT / "docs").as_posix()
    for program in programs():
        places[f"examples/{program.name}"] = example_page_name(program)
    return places | FOLDERS


def example_page_name(program: Path) -> str:
    """Name the page of an example on the site."""
    return f"{EXAMPLES.removesuffix('.md')}/{program.stem}.md"


def site_text(name: str, text: str, places: dict[str, str]) -> str:
    """Write a page for the site: its links, its titles of blocks as captions, below an index its contents."""
    page = read_page(text)
    linked = with_site_links(name, text, places, posixpath.dirname(places[name]))
    return with_captions(linked, page.blocks) + contents(places[name], page, name, places)


def with_site_links(name: str, text: str, places: dict[str, str], folder: str) -> str:
    """Lead the links of a page to the places of their targets.

    Args:
        name: of the page in the repository, to which its links are relative.
        text: all of it, or a part.
        places: where pages and folders of the repository are on the site.
        folder: in which the text stands on the site.

    Raises:
        ValueError: a link to something that is not there, or to a folder without a page.
    """
    for link in sorted(read_page(text).links(), key=lambda link: -link.start):
        if link.target.startswith(ELSEWHERE) or link.target.startswith("#"):
            continue
        path, mark, anchor = link.target.partition("#")
        wanted = posixpath.normpath(posixpath.join(posixpath.dirname(name), path))
        try:
            target = posixpath.relpath(place_of(wanted, places), folder)
        except ValueError as error:
            raise ValueError(f"{name}:{link.line}: {link.target}: {error}") from None
        text = f"{text[: link.start]}{target}{mark}{anchor}{text[link.start + len(link.target) :]}"
    return text


def place_of(wanted: str, places: dict[str, str]) -> str:
    """Find the place of a page, folder or file on the site; a file that is no page is copied there.

    Raises:
        ValueError: it is not there, is a folder without a page, or a text that Sphinx would take for a page.
    """
    if wanted in places:
        return places[wanted]
    path = ROOT / wanted
    if not path.is_file():
        raise ValueError("a folder without a page" if path.exists() else "there is no such file")
    if path.suffix == ".md":
        raise ValueError("a page that is not on the site")
    place = wanted.removeprefix("docs/") if wanted.startswith("docs/") else f"files/{wanted}"
    target = SOURCE / place
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(path, target)
    return place


def with_captions(text: str, blocks: Iterable[Block]) -> str:
    """Turn the titles of blocks into captions, which readers of the site see."""
    lines = text.split("\n")
    for block in blocks:
        title = block.words.get("title")
        fence, language, _ = lines[block.line - 1].partition(block.language) if title else ("", "", "")
        if title:
            lines[block.line - 1] = f"{fence}{{code-block}} {language}\n:caption: {title}\n"
    return "\n".join(lines)


def contents(place: str, page: Page, name: str, places: dict[str, str]) -> str:
    """Write the tables of contents of an index, one for each of its sections, named as the index names the pages.

    Pages that count are those in its own folder and the indexes one below.
    """
    folder = posixpath.dirname(place)
    if place == OTHER_PAGES["tests/spec/README.md"]:
        pages = sorted(posixpath.basename(other) for other in places.values() if posixpath.dirname(other) == folder)
        return toctree("", [other for other in pages if other != "index.md"])
    if not place.endswith("index.md") and place != EXAMPLES:
        return ""
    child = re.compile(r"examples/[\w-]+\.md" if place == EXAMPLES else r"(?!index\.md)[\w-]+\.md|[\w-]+/index\.md")
    sections: dict[str, list[str]] = {"": []}
    seen: set[str] = set()
    for number, _, line in page.prose:
        if line.startswith("## "):
            sections[line[3:]] = []
        for link in (link for link in page.links() if link.line == number):
            target = posixpath.normpath(posixpath.join(posixpath.dirname(name), link.target.partition("#")[0]))
            other = posixpath.relpath(places.get(target, place), folder or ".")
            if child.fullmatch(other) and other not in seen:
                seen.add(other)
                title = page.text[: link.start].rpartition("[")[2].removesuffix("](").strip("`").removesuffix(".script")
                list(sections.values())[-1].append(f"{title} <{other}>")
    filled = {title: listed for title, listed in sections.items() if listed}
    return "".join(toctree(title if len(filled) > 1 else "", listed) for title, listed in filled.items())


def toctree(caption: str, entries: list[str]) -> str:
    head = f":caption: {caption}\n" if caption else ""
    return f"\n```{{toctree}}\n:hidden:\n{head}\n" + "".join(f"{entry}\n" for entry in entries) + "```\n"


def write_page(place: str, text: str) -> None:
    target = SOURCE / place
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(text, encoding="utf-8")


def example_page(program: Path, about: str) -> str:
    """Write the page of an example: what it shows, its plot, its text and the files beside it.

    Args:
        program: the file.
        about: what docs/how-to/examples.md says of it, for its place on the site.
    """
    plot = f"{program.stem}.plot.html"
    lines = [
        "---",
        "html_theme.sidebar_secondary.remove: true",
        "---",
        "",
        f"# {program.stem}",
        "",
        about.strip(),
        "",
        "```sh",
        " ".join(["elitescript run", f"examples/{program.name}", *options(program)]),
        "```",
        "",
        "## The run",
        "",
        "```{raw} html",
        f'<p><a href="{plot}">This plot on a page of its own</a></p>',
        f'<iframe class="plot" src="{plot}" title="Plot of the run of {program.name}" loading="lazy"></iframe>',
        "```",
        "",
        "## The program",
        "",
        *code(program),
    ]
    for path in sorted(program.parent.glob(f"{program.stem}.*")):
        if path != program and path.suffix in LANGUAGES:
            lines += ["", f"## {path.name}", "", *code(path)]
    return "\n".join(lines) + "\n"


def options(program: Path) -> list[str]:
    """List the options that the head of an example asks for."""
    return [word for option in ("--set", "--world") for value in settings(program, option) for word in (option, value)]


def code(path: Path) -> list[str]:
    text = path.read_text(encoding="utf-8").rstrip("\n")
    return [f"````{{code-block}} {LANGUAGES[path.suffix]}", f":caption: {path.name}", "", text, "````"]


def example_sections(text: str) -> dict[str, str]:
    """Cut the page of examples into what it says of each: the text below the heading with its name."""
    found: dict[str, str] = {}
    name = ""
    for line in text.split("\n"):
        if line.startswith("#"):
            name = line[4:].strip() if line.startswith("### ") else ""
        elif name:
            found[name] = found.get(name, "") + line + "\n"
    return found


def models_page() -> str:
    """Write the page of the arms: the text of each data file."""
    lines = ["# Arms", "", "The data of each arm, every number with its source. Any of them can be changed in"]
    lines += ["[an arm of one's own](../how-to/python.md#an-arm-of-ones-own)."]
    for path in sorted((ROOT / MODELS).glob("*.toml")):
        lines += ["", f"## {path.stem}", "", *code(path)]
    return "\n".join(lines) + "\n"


def draw_plot(program: Path) -> None:
    """Run an example as its head says and write the plot of the run."""
    target = BUILD / "extra" / Path(example_page_name(program)).with_suffix(".plot.html")
    target.parent.mkdir(parents=True, exist_ok=True)
    call = ["plot", f"examples/{program.name}", *options(program), "--output", str(target)]
    done = subprocess.run(
        [sys.executable, "-m", "elitescript", *call], cwd=ROOT, check=False, capture_output=True, text=True
    )
    if done.returncode:
        raise SystemExit(f"elitescript {' '.join(call)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")


def write_sources() -> None:
    """Write everything that Sphinx reads."""
    shutil.rmtree(BUILD, ignore_errors=True)
    places = site_pages()
    for name, place in places.items():
        if name.endswith(".md") and not name.startswith("README"):
            write_page(place, site_text(name, (ROOT / name).read_text(encoding="utf-8"), places))
    name = f"docs/{EXAMPLES}"
    about = example_sections((ROOT / name).read_text(encoding="utf-8"))
    for program in programs():
        place = example_page_name(program)
        shown = with_site_links(name, about[program.stem], places, posixpath.dirname(place))
        write_page(place, example_page(program, shown))
    write_page("reference/models.md", models_page())
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(draw_plot, programs()))


def main() -> int:
    """Write the sources and build the site from them."""
    write_sources()
    call = [
        sys.executable,
        "-m",
        "sphinx",
        "-W",
        "--keep-going",
        "-q",
        "-b",
        "html",
        "-c",
        str(SETTINGS),
        "-d",
        str(BUILD / "doctrees"),
    ]
    return subprocess.run([*call, str(SOURCE), str(HTML)], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
