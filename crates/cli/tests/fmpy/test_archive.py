"""The archive as the FMI standard wants it, and the same bytes every time."""

import re
import stat
import struct
import zipfile

import pytest
from conftest import EFFECTS, SCENES

DEFLATE = 8
DATA_DESCRIPTOR = 1 << 3


def local_headers(path):
    """Name, version needed, flags and method of each entry, as they stand before its content;
    zipfile itself shows the directory at the end."""
    content = path.read_bytes()
    with zipfile.ZipFile(path) as archive:
        for entry in archive.infolist():
            header = struct.unpack_from("<4s3H", content, entry.header_offset)
            length = struct.unpack_from("<H", content, entry.header_offset + 26)[0]
            name = content[entry.header_offset + 30 :][:length]
            assert header[0] == b"PK\x03\x04"
            yield name.decode(), *header[1:]


@pytest.mark.parametrize("scene", SCENES)
def test_entries_are_plain_deflated_files_of_zip_version_2_0(fmus, scene):
    with zipfile.ZipFile(fmus[scene]) as archive:
        assert archive.testzip() is None
        central = [
            (entry.orig_filename, entry.extract_version, entry.flag_bits, entry.compress_type)
            for entry in archive.infolist()
        ]
        modes = [entry.external_attr >> 16 for entry in archive.infolist()]
    assert central == list(local_headers(fmus[scene]))
    for name, version, flags, method in central:
        assert (version, method) == (20, DEFLATE), name
        assert not flags & DATA_DESCRIPTOR, name
    assert all(stat.S_IFMT(mode) in (0, stat.S_IFREG) for mode in modes)


@pytest.mark.parametrize("scene", SCENES)
def test_names_are_relative_with_forward_slashes_and_unique(fmus, scene):
    with zipfile.ZipFile(fmus[scene]) as archive:
        names = [entry.orig_filename for entry in archive.infolist()]
    assert len(names) == len(set(names))
    for name in names:
        assert re.fullmatch(r"[A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]+)*", name), name
        assert ".." not in name.split("/"), name
    assert "modelDescription.xml" in names
    assert "resources/scene.toml" in names
    assert any(re.fullmatch(rf"binaries/\w+/{scene}\.\w+", name) for name in names)


@pytest.mark.parametrize("scene", SCENES)
def test_two_exports_have_the_same_bytes(fmus, amontons, tmp_path, scene):
    again = tmp_path / "again.fmu"
    amontons("export", EFFECTS.get(scene, scene), "-o", again)
    assert again.read_bytes() == fmus[scene].read_bytes()


def test_without_a_date_there_is_none(unpacked):
    assert unpacked("set1").xml.get("generationDateAndTime") is None


def test_source_date_epoch_is_the_date_of_the_fmu(fmus, amontons, tmp_path):
    paths = [tmp_path / "a.fmu", tmp_path / "b.fmu"]
    for path in paths:
        amontons("export", "set1", "-o", path, SOURCE_DATE_EPOCH="1000000000")
    assert paths[0].read_bytes() == paths[1].read_bytes() != fmus["set1"].read_bytes()
    with zipfile.ZipFile(paths[0]) as archive:
        description = archive.read("modelDescription.xml").decode()
        dates = {entry.date_time for entry in archive.infolist()}
    # 10⁹ s after 1970 in UTC, which the Z says.
    assert 'generationDateAndTime="2001-09-09T01:46:40Z"' in description
    assert dates == {(2001, 9, 9, 1, 46, 40)}
