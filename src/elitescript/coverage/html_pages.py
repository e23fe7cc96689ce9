"""Coverage as HTML pages that need nothing else: an index, and a page for each program."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from html import escape
from typing import Final

from elitescript.coverage.model import Numbers, ProgramCoverage, percent_text, total
from elitescript.coverage.unmet import Unmet
from elitescript.page import MARK

INDEX: Final = "index.html"

_STYLE: Final = """
:root { color-scheme: light dark; --text: #1f2328; --faint: #59636e; --back: #fff; --line: #d1d9e0; --link: #0758b5;
  --hit: #1a7f37; --miss: #cf222e; --part: #9a6700; --missed-back: #ffebe9; --part-back: #fff8c5; }
@media (prefers-color-scheme: dark) { :root { --text: #e6edf3; --faint: #9198a1; --back: #0d1117; --line: #3d444d;
  --link: #6cb6ff; --hit: #3fb950; --miss: #ff7b72; --part: #d29922; --missed-back: #3d1a1d; --part-back: #332b0e; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 75rem; padding: 1rem; color: var(--text); background: var(--back);
  font: 1rem/1.5 system-ui, sans-serif; }
a { color: var(--link); }
h1 { font-size: 1.4rem; overflow-wrap: anywhere; } h2 { font-size: 1.15rem; margin-top: 2rem; }
h3 { font-size: 1rem; margin-bottom: .3rem; } ul { margin: 0; padding-left: 1.2rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
.numbers th, .numbers td { padding: .3rem .8rem; border-bottom: 1px solid var(--line); text-align: right;
  white-space: nowrap; }
.numbers th:first-child, .numbers td:first-child { text-align: left; padding-left: 0; }
.numbers tfoot td { font-weight: 600; border-bottom: 0; }
.bar { display: inline-block; width: 6rem; height: .6rem; margin-right: .5rem; background: var(--miss); }
.share { display: inline-block; min-width: 3rem; }
.bar i { display: block; height: 100%; background: var(--hit); }
.code { width: 100%; font: .85rem/1.45 ui-monospace, monospace; tab-size: 2; }
.code td { padding: 0 .6rem; vertical-align: top; white-space: pre; }
.code .number, .code .hits { text-align: right; color: var(--faint); user-select: none; }
.code .hits { border-right: 3px solid transparent; }
.code .hit .hits { border-color: var(--hit); } .code .miss .hits { border-color: var(--miss); }
.code .part .hits { border-color: var(--part); }
.code .miss td { background: var(--missed-back); } .code .part td { background: var(--part-back); }
.code .note { color: var(--part); text-align: right; } .code .text { width: 100%; }
li { overflow-wrap: anywhere; } .faint { color: var(--faint); }
"""


def html_pages(programs: Sequence[ProgramCoverage], unmet: Unmet) -> dict[str, str]:
    """Return the text of each file by its name; `INDEX` is the first."""
    names = _names(programs)
    pages = {INDEX: _index(programs, names, unmet)}
    for program, name in zip(programs, names, strict=True):
        pages[name] = _program(program)
    return pages


def _names(programs: Iterable[ProgramCoverage]) -> list[str]:
    """Return a file name for each program, no two alike on disks that ignore case."""
    names: list[str] = []
    known = {INDEX}
    for program in programs:
        stem = re.sub(r"[^\w.]+", "-", program.path)
        name, number = f"{stem}.html", 2
        while name.lower() in known:
            name, number = f"{stem}-{number}.html", number + 1
        known.add(name.lower())
        names.append(name)
    return names


def _page(title: str, body: Iterable[str]) -> str:
    head = (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n{MARK}\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
    )
    return head + "\n".join(body) + "\n</body>\n</html>\n"


def _index(programs: Sequence[ProgramCoverage], names: Sequence[str], unmet: Unmet) -> str:
    body = ["<h1>Coverage of robot programs</h1>", '<div class="wide"><table class="numbers">', "<thead><tr>"]
    body += [f"<th>{title}</th>" for title in ("Program", "Cover", "Lines", "Branches", "Functions")]
    body.append("</tr></thead><tbody>")
    for program, name in zip(programs, names, strict=True):
        body.append(_row(f'<a href="{escape(name)}">{escape(program.path)}</a>', program.numbers))
    body += ["</tbody><tfoot>", _row("all", total(programs)), "</tfoot></table></div>"]
    sections = [(title, items) for title, items in unmet.sections() if items]
    if sections:
        body.append("<h2>What no test has met</h2>")
    for title, items in sections:
        body.append(f"<h3>{escape(title.capitalize())}</h3><ul>")
        body += [f"<li>{escape(item)}</li>" for item in items]
        body.append("</ul>")
    if unmet.alarms:
        body.append(f'<p class="faint">Alarms and refusals that tests have met: {escape(", ".join(unmet.alarms))}.</p>')
    return _page("Coverage of robot programs", body)


def _row(name: str, numbers: Numbers) -> str:
    share = f'<span class="bar"><i style="width:{numbers.percent:.1f}%"></i></span>'
    share += f'<span class="share">{percent_text(numbers.percent)}</span>'
    counts = (
        share,
        f"{numbers.lines_hit} of {numbers.lines}",
        f"{numbers.branches_hit} of {numbers.branches}",
        f"{numbers.functions_hit} of {numbers.functions}",
    )
    return f"<tr><td>{name}</td>{''.join(f'<td>{cell}</td>' for cell in counts)}</tr>"


def _program(program: ProgramCoverage) -> str:
    numbers = program.numbers
    body = [
        f'<p><a href="{INDEX}">All programs</a></p>',
        f"<h1>{escape(program.path)}</h1>",
        f"<p>{percent_text(numbers.percent)}: {numbers.lines_hit} of {numbers.lines} lines, "
        f"{numbers.branches_hit} of {numbers.branches} branches, "
        f"{numbers.functions_hit} of {numbers.functions} functions.</p>",
        '<div class="wide"><table class="code">',
    ]
    for number, text in enumerate(program.source, 1):
        hits = program.lines.get(number)
        branches = program.branches_of(number)
        missed = [branch for branch in branches if branch.hits == 0]
        kind = "" if hits is None else "miss" if not hits else "part" if missed else "hit"
        note = f"never taken: {', '.join(branch.text for branch in missed)}" if missed else ""
        ways = "; ".join(f"{branch.text}: {branch.hits or 0}" for branch in branches)
        body.append(
            f'<tr id="L{number}" class="{kind}"><td class="number">{number}</td>'
            f'<td class="hits"{f" title={_quoted(ways)}" if ways else ""}>{"" if hits is None else hits}</td>'
            f'<td class="text">{escape(text)}</td><td class="note">{escape(note)}</td></tr>'
        )
    body.append("</table></div>")
    if program.places:
        body.append('<h2>Nodes</h2><div class="wide"><table class="numbers"><tr><th>Node</th><th>Runs</th></tr>')
        for node in program.nodes:
            kind = "" if node.hits else ' class="miss"'
            body.append(f"<tr{kind}><td>{escape(node.place)}</td><td>{node.hits}</td></tr>")
        body.append("</table></div>")
    if program.functions:
        body.append(
            '<h2>Functions</h2><div class="wide"><table class="numbers"><tr><th>Function</th><th>Calls</th></tr>'
        )
        for function in program.functions:
            link = f'<a href="#L{function.line}">{escape(function.name)}</a>'
            body.append(f"<tr><td>{link}</td><td>{function.hits}</td></tr>")
        body.append("</table></div>")
    return _page(program.path, body)


def _quoted(text: str) -> str:
    return f'"{escape(text)}"'
