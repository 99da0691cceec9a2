"""Programs as archives and as wheels: the same bytes for the same files, whenever and wherever they are packed."""

import base64
import gzip
import hashlib
import io
import tarfile
import time
import tomllib
import zipfile
from pathlib import Path

import tools
from tools import PACKAGES, ROOT, VERSION

EXECUTABLE, PLAIN = 0o755, 0o644
PYTHON = ROOT / "crates/python"
THIRD_PARTY = "LICENSES-THIRD-PARTY.txt"


def contents(programs, licences):
    """Names in an archive, content, mode; sorted. `licences` are those of others, as one text."""
    # With what the README leads to.
    texts = ["README.md", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "LICENSE-APACHE", "LICENSE-MIT"]
    texts += ["docs", "examples", "scenes"]
    files = [(program.name, program, EXECUTABLE) for program in programs]
    files += [(name, ROOT / name, PLAIN) for name in tools.output(["git", "ls-files", *texts]).splitlines()]
    packed = [(name, path.read_bytes(), mode) for name, path, mode in files]
    return sorted([*packed, (THIRD_PARTY, licences.encode(), PLAIN)])


def tar(programs, licences):
    top = f"amontons-{VERSION}-linux64"
    packed = io.BytesIO()
    # An empty name and a set time: gzip would put its own there.
    with gzip.GzipFile("", "wb", 9, packed, mtime=tools.date()) as stream:
        with tarfile.open(fileobj=stream, mode="w", format=tarfile.USTAR_FORMAT) as archive:
            for name, content, mode in contents(programs, licences):
                entry = tarfile.TarInfo(f"{top}/{name}")
                entry.size, entry.mode, entry.mtime = len(content), mode, tools.date()
                archive.addfile(entry, io.BytesIO(content))
    write(f"{top}.tar.gz", packed.getvalue())


def zip(programs, licences):
    top = f"amontons-{VERSION}-win64"
    write(f"{top}.zip", zipped([(f"{top}/{name}", *rest) for name, *rest in contents(programs, licences)]))


def zipped(files):
    packed = io.BytesIO()
    # Zip knows no time before 1980, and no time zones.
    date = max(time.gmtime(tools.date())[:6], (1980, 1, 1, 0, 0, 0))
    with zipfile.ZipFile(packed, "w") as archive:
        for name, content, mode in files:
            entry = zipfile.ZipInfo(name, date)
            entry.create_system, entry.external_attr = 3, (0o100000 | mode) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content, compresslevel=9)
    return packed.getvalue()


def wheel(programs, module, platform, licences):
    """A wheel with the Python module, whose compiled part is `module`, and with the programs as its scripts: pip puts
    them on the path."""
    project = tomllib.loads((PYTHON / "pyproject.toml").read_text())["project"]
    stem = f"amontons-{VERSION}"
    # The stable interface of CPython from 3.10 on.
    tag = f"cp310-abi3-{platform}"
    info = f"{stem}.dist-info"
    needed = [f"Requires-Dist: {package}\n" for package in project["dependencies"]]
    for extra, packages in project["optional-dependencies"].items():
        needed.append(f"Provides-Extra: {extra}\n")
        needed += [f"Requires-Dist: {package}; extra == '{extra}'\n" for package in packages]
    metadata = (
        f"Metadata-Version: 2.4\nName: amontons\nVersion: {VERSION}\n"
        f"Summary: {project['description']}\nRequires-Python: {project['requires-python']}\n{''.join(needed)}"
        "License-Expression: MIT OR Apache-2.0\nLicense-File: LICENSE-APACHE\nLicense-File: LICENSE-MIT\n"
        f"License-File: {THIRD_PARTY}\n"
        f"Description-Content-Type: text/markdown\n\n{(ROOT / 'README.md').read_text()}"
    )
    about = f"Wheel-Version: 1.0\nGenerator: amontons-release\nRoot-Is-Purelib: false\nTag: {tag}\n"
    sources = tools.output(["git", "ls-files", PYTHON / "python/amontons"]).splitlines()
    files = [(f"amontons/{Path(name).name}", (ROOT / name).read_bytes(), PLAIN) for name in sorted(sources)]
    files.append((f"amontons/_core{module.suffix.replace('.so', '.abi3.so')}", module.read_bytes(), EXECUTABLE))
    files += [(f"{stem}.data/scripts/{program.name}", program.read_bytes(), EXECUTABLE) for program in programs]
    files += [(f"{info}/METADATA", metadata.encode(), PLAIN), (f"{info}/WHEEL", about.encode(), PLAIN)]
    for licence in ["LICENSE-APACHE", "LICENSE-MIT"]:
        files.append((f"{info}/licenses/{licence}", (ROOT / licence).read_bytes(), PLAIN))
    files.append((f"{info}/licenses/{THIRD_PARTY}", licences.encode(), PLAIN))
    record = "".join(f"{name},sha256={digest(content)},{len(content)}\n" for name, content, _ in files)
    files.append((f"{info}/RECORD", f"{record}{info}/RECORD,,\n".encode(), PLAIN))
    write(f"{stem}-{tag}.whl", zipped(files))


def digest(content):
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def write(name, content):
    PACKAGES.mkdir(parents=True, exist_ok=True)
    (PACKAGES / name).write_bytes(content)


def sums():
    """SHA256SUMS of all packages of this version, for `sha256sum --check`."""
    packages = sorted(path for path in PACKAGES.glob(f"amontons-{VERSION}-*"))
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in packages]
    (PACKAGES / "SHA256SUMS").write_text("".join(lines))
    return PACKAGES / "SHA256SUMS"
