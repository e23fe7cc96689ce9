"""What folds."""

from __future__ import annotations

import pytest

from elitescript.assist.document import Document
from elitescript.assist.folding import folding_ranges


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def f():\n  pass\nend\n", ["1-3 block"]),
        ("def f():\n  pass\n\n\nx = 1\n", ["1-2 block"]),
        ("if a:\n  x = 1\nelif b:\n  x = 2\nelse:\n  x = 3\nend\n", ["1-2 block", "3-4 block", "5-7 block"]),
        ("try:\n  if a:\n    b()\n  end\nexcept E:\n  pass\nend\n", ["1-4 block", "2-4 block", "5-7 block"]),
        ("match a:\n  case 1:\n    b()\n  case 2:\n    c()\nend\n", ["1-6 block", "2-3 block", "4-5 block"]),
        ("# a\n# b\n# c\nx = 1\n# d\n", ["1-3 comment"]),
        ("x = 1  # a\n# b\n\n# c\n", []),
        ("import a\nfrom b import c\nx = 1\nimport d\n", ["1-2 imports"]),
        ("q = [\n  1,\n  2,\n]\ns = '''\n# a\n# b\n'''\n", ["1-4 lines", "5-8 lines"]),
        ("def f(a,\n      b):\n  pass\nend\n", ["1-4 block"]),
        ("# HEADER_BEGIN\nx = 1\n# HEADER_END\n", ["1-3 region"]),
        ("# NODE_CONTROL_LOOP_BEGINS\nx = 1\n# NODE_CONTROL_LOOP_ENDS\n", ["1-3 region"]),
        ("# begin: gripper\nx = 1\n# end: gripper\n", ["1-3 region"]),
        ("#region a\n# region b\nx = 1\n# endregion\n#endregion a\n", ["1-5 region", "2-4 region"]),
        ("# the end\n# begins of a\n# END\n", ["2-3 comment"]),
        ("# A_BEGIN\n# B_END\nx = 1\n", []),
        ('$ LINE: (1, "a")\nx = 1\n$ LINE: (2, "b")\nx = 2\n', ["1-2 node", "3-4 node"]),
        ("def f():\n  x = (\n  pass\nend\n", ["1-4 block"]),
        ("def f():\r  pass\r  pass", ["1-3 block"]),
    ],
)
def test_folds(text: str, expected: list[str]) -> None:
    found = folding_ranges(Document("cell.script", text))
    assert [f"{fold.line}-{fold.end_line} {fold.kind}" for fold in found] == expected
