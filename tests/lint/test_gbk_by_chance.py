from __future__ import annotations

import pytest

from tests.lint.checking import found, only


def test_a_text_in_gbk_that_is_utf_8_by_chance_is_found_once():
    text = "# 停止\ndef job():\n  textmsg('停止')\nend\n".encode("gbk").decode()
    assert found(text) == ["W222 1:3"]
    assert only(text).text.endswith("as GBK the line reads `# 停止`")
    assert only(text).fix is None


@pytest.mark.parametrize("said", ["停止", "привет", "größer", "25 °C", "מה", "停止 é"])
def test_other_texts_are_fine(said):
    assert found(f"def job():\n  textmsg('{said}')\nend\n") == []
