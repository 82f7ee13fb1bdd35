from pathlib import Path

import pytest

from hardware.options import BadOption, read_token


def test_a_token_comes_from_the_file_or_is_the_one_given(tmp_path: Path) -> None:
    file = tmp_path / "token"
    file.write_text("prunus_a_b\n")
    assert read_token(file, "other") == "prunus_a_b"
    assert read_token(None, " other\n") == "other"
    assert read_token(None, "") == ""
    with pytest.raises(FileNotFoundError):
        read_token(tmp_path / "absent", "other")


@pytest.mark.parametrize(
    "content", [b"", b"\n", b"qq7z qq7z", b"qq7z\nqq7z", b"qq7z\xff", b"q\x00"]
)
def test_what_is_no_token_is_refused_and_not_told(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "token"
    file.write_bytes(content)
    with pytest.raises(BadOption) as raised:
        read_token(file, "")
    assert "--token-file" in str(raised.value)
    assert "qq7z" not in str(raised.value)
