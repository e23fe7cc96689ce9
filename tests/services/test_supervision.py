"""How long a child may take to compile a program text."""

from __future__ import annotations

import time

from elitescript.language.options import Options
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import compile_checked
from elitescript.messages.profile import profile
from elitescript.models.model import load_model
from elitescript.services.child.supervision import compile_s

LINE = "  movel([0.4, 0.012, 0.3, 3.14, 0, 0], a=1.2, v=0.25, r=0.0)\n"


def test_a_longer_text_has_a_longer_budget() -> None:
    assert compile_s(0) == 0.0
    assert compile_s(1_000_000) == 40.0
    assert compile_s(4 * 1024 * 1024) == 160.0


def test_checking_and_compiling_takes_less_than_half_of_the_budget() -> None:
    text = f"def long():\n{LINE * 500}end\n"
    arguments = SourceFile("long", text), profile("2.14"), Options()
    compile_checked(*arguments, arm=load_model("CS66"))
    began_s = time.process_time()
    compile_checked(*arguments, arm=load_model("CS66"))
    assert time.process_time() - began_s < compile_s(len(text)) / 2
