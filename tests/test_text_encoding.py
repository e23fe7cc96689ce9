import pytest

from elitescript.text_encoding import as_gbk, by_chance, decoded_from, likely_gbk
from elitescript.untrusted.plain_text import EncodingError, plain_text


@pytest.mark.parametrize("text", ["移动到原点", 'textmsg("开始")\r\n', "合格,1.5", "# 抓取位置速度"])
def test_gbk_is_recognised(text):
    assert decoded_from(text.encode("gbk")) == (text, "GBK")


@pytest.mark.parametrize("codec", ["utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("said", ["好", "开始", "一二三四五六七", "x"])
def test_utf_16_is_recognised(codec, said):
    """The lower byte of `开` and `一` is zero."""
    text = f"# {said}\r\ndef job():\r\n  textmsg('{said}')\r\nend\r\n"
    assert decoded_from(text.encode(codec)) == (text, "UTF-16")
    with pytest.raises(EncodingError, match="UTF-16"):
        plain_text(text.encode(codec))


@pytest.mark.parametrize("data", [b"def a():\n\xff\xfe\0", b"x = 1\n\0\0", b"\0" * 64, bytes(range(256))])
def test_bytes_with_zeros_are_not(data):
    assert decoded_from(data) is None


@pytest.mark.parametrize("text", ["Grüße", "größer", "für Käse über", "naïve café", "x = 25 °C", "±5 µm"])
def test_latin_1_is_not(text):
    assert decoded_from(text.encode("latin-1")) is None


@pytest.mark.parametrize(
    "data", ["привет".encode("cp1251"), b"\xff", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", b"", b"x = 1", "好".encode()]
)
def test_other_bytes_are_not(data):
    assert decoded_from(data) is None


@pytest.mark.parametrize("text", ["停止", "一", "取", 'textmsg("停")\n'])
def test_gbk_that_is_utf_8_by_chance(text):
    data = text.encode("gbk")
    assert as_gbk(data) is None
    assert by_chance(data.decode()) == text == likely_gbk(data)


@pytest.mark.parametrize(
    "text",
    [
        "привет мир",
        "Ελλάδα",
        "שלום",
        "مرحبا",
        "é ñ ç",
        "łódź",
        "25 °C ± 5 µm",
        "温度 停止",
        "",
        "x",
        "naïve",
        "Ёлка ї є",
        "“好”",
    ],
)
def test_texts_of_other_scripts_are_what_they_seem(text):
    assert by_chance(text) is None


def test_a_received_text_may_be_cut_in_a_character():
    assert likely_gbk("合格".encode("gbk")[:-1]) == "合"
