"""The user's URDF and its meshes are given away, and nothing else of this computer."""

from __future__ import annotations

from base64 import b64decode
from pathlib import Path

import pytest

from elitescript.errors import UsageError
from elitescript.studio import meshes
from elitescript.studio.meshes import Meshes


@pytest.fixture
def package(tmp_path: Path) -> Path:
    home = tmp_path / "arm_description"
    for name, data in {
        "package.xml": b"<package/>",
        "urdf/arm.urdf": "<robot name='Größe'/>".encode(),
        "urdf/near.stl": b"near",
        "meshes/link.STL": b"\x00\xff" * 100,
        "meshes/notes.txt": b"notes",
    }.items():
        (home / name).parent.mkdir(parents=True, exist_ok=True)
        (home / name).write_bytes(data)
    (tmp_path / "secret.stl").write_bytes(b"secret")
    return home


def test_the_urdf_and_its_meshes(package: Path) -> None:
    found = Meshes(package / "urdf" / "arm.urdf")
    assert found.urdf() == {"name": "arm.urdf", "text": "<robot name='Größe'/>"}
    for name in ("package://arm_description/meshes/link.STL", "../meshes/link.STL"):
        mesh = found.file(name)
        assert (mesh["name"], b64decode(mesh["base64"])) == (name, b"\x00\xff" * 100)
    assert b64decode(found.file("near.stl")["base64"]) == b"near"


def test_without_a_package_the_folder_of_the_file_is_all(package: Path) -> None:
    (package / "package.xml").unlink()
    found = Meshes(package / "urdf" / "arm.urdf")
    assert found.file("near.stl")
    assert found.file("package://arm_description/near.stl")
    with pytest.raises(UsageError, match="is outside"):
        found.file("../meshes/link.STL")


@pytest.mark.parametrize(
    "name",
    [
        "../../secret.stl",
        "package://arm_description/../secret.stl",
        "package://../../secret.stl",
        "link.stl",
        "../meshes/notes.txt",
        "../package.xml",
        "/etc/passwd",
        "file:///etc/passwd",
        "no.stl",
        "",
        "a\0.stl",
        "..",
    ],
)
def test_nothing_else(package: Path, name: str) -> None:
    (package / "urdf" / "link.stl").symlink_to(package.parent / "secret.stl")
    with pytest.raises(UsageError):
        Meshes(package / "urdf" / "arm.urdf").file(name)


def test_what_is_no_urdf(package: Path, monkeypatch) -> None:
    with pytest.raises(UsageError, match="No such file"):
        Meshes(package / "no.urdf")
    (package / "latin.urdf").write_bytes(b"\xff")
    with pytest.raises(UsageError, match="is not UTF-8"):
        Meshes(package / "latin.urdf")
    monkeypatch.setattr(meshes, "MESH", meshes.MESH._replace(bytes_max=10))
    with pytest.raises(UsageError, match="at most 10 bytes are read"):
        Meshes(package / "urdf" / "arm.urdf")
