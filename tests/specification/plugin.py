"""Collects specification pages as tests: a pytest plugin."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.specification.pages import Case, Expectation, parse_page

FOLDER = Path(__file__).resolve().parent.parent / "spec"
"""Where the pages are."""


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect the pages of the folder."""
    if file_path.suffix == ".md" and file_path.is_relative_to(FOLDER):
        return Page.from_parent(parent, path=file_path)
    return None


class Page(pytest.File):
    """Collects the cases of one page."""

    def collect(self) -> Iterator[pytest.Item]:
        """Yield one test for each expectation of each case."""
        for case in parse_page(self.path.read_text(encoding="utf-8")):
            for expectation in case.expectations:
                name = f"{case.title} [{expectation.label}]" if expectation.label else case.title
                yield SpecItem.from_parent(self, name=name, case=case, expectation=expectation)


class SpecItem(pytest.Item):
    """Runs one case under one set of conditions."""

    def __init__(self, *, case: Case, expectation: Expectation, **rest: Any) -> None:
        super().__init__(**rest)
        self.case = case
        self.expectation = expectation

    def runtest(self) -> None:
        """Run the case; a difference is a failure."""
        if self.case.needs:
            pytest.skip(f"needs {self.case.needs}")
        from tests.specification.running import run_case

        found = run_case(self.case, self.expectation)
        if found:
            raise SpecFailure(found)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return the differences and the program, instead of a traceback of the runner."""
        if not isinstance(excinfo.value, SpecFailure):
            return super().repr_failure(excinfo, style)
        rows = [f"{self.path}:{self.expectation.line}: {self.case.title}", ""]
        for text in self.case.texts:
            rows += [f"{number:4} {line}" for number, line in enumerate(text.text.splitlines(), 1)]
            rows.append("")
        return "\n".join([*rows, *excinfo.value.differences])

    def reportinfo(self) -> tuple[Path, int, str]:
        """Return where the case stands."""
        return self.path, self.expectation.line - 1, self.name


class SpecFailure(Exception):
    """The outcome is not the expected one."""

    def __init__(self, differences: list[str]) -> None:
        super().__init__("\n".join(differences))
        self.differences = differences
