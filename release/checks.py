"""What a file of a release may ask of the machine that it runs on, and what it may not tell of this one."""

import re
from pathlib import Path

import tools

GLIBC = (2, 17)
# glibc's own, and the loader.
LINUX = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "librt.so.1", "ld-linux-x86-64.so.2"}
INEXACT = re.compile(
    r"(a?(sin|cos|tan)h?|sincos|atan2|exp(2|10|m1)?|log(2|10|1p)?|pow|cbrt|hypot|erfc?|[lt]gamma)f?"
)
# Part of Windows 10 and later.
WINDOWS = re.compile(
    r"(kernel32|ntdll|msvcrt|advapi32|userenv|ws2_32|bcrypt|bcryptprimitives|user32|shell32|ole32|dwrite|gdi32"
    # The Python that loads the module.
    r"|api-ms-win-[a-z0-9-]+|python3)\.dll"
)


def linux(file):
    floor = glibc_floor(file)
    if floor > GLIBC:
        raise tools.Failed(f"{file} needs glibc {floor[0]}.{floor[1]}, later than {GLIBC[0]}.{GLIBC[1]}")
    needed = set(re.findall(r"NEEDED\s+(\S+)", tools.output(["objdump", "-p", file])))
    if needed - LINUX:
        raise tools.Failed(f"{file} needs {', '.join(sorted(needed - LINUX))} besides glibc")
    says_nothing_of_this_machine(file)
    print(f"   {file.name}: glibc {floor[0]}.{floor[1]} or later; {file.stat().st_size // 1000} kB")


def glibc_floor(file):
    """The latest version of glibc that any symbol is wanted of."""
    versions = re.findall(r"\bGLIBC_(\d+)\.(\d+)", tools.output(["objdump", "-T", file]))
    if not versions:
        raise tools.Failed(f"{file} wants no symbol of glibc: it is not what it should be")
    return max((int(major), int(minor)) for major, minor in versions)


def linux_library(file):
    """As a program, and no function of libm whose last bit is glibc's own matter: an FMU gives the same doubles
    everywhere. Of the Windows library this is not looked at: mingw has some of them inside, and its runtime asks for
    others that nothing calls. It is of the same sources."""
    symbols = set(re.findall(r"\*UND\*.*\s(\w+)$", tools.output(["objdump", "-T", file]), re.MULTILINE))
    inexact = {name for name in symbols if INEXACT.fullmatch(name)}
    if inexact:
        raise tools.Failed(f"{file} computes with the system's own {', '.join(sorted(inexact))}")
    linux(file)


def windows(file):
    imports = re.findall(r"DLL Name: (\S+)", tools.output([f"{tools.MINGW}objdump", "-p", file]))
    foreign = sorted({name for name in imports if not WINDOWS.fullmatch(name.lower())})
    if foreign or not imports:
        raise tools.Failed(f"{file} imports {', '.join(foreign) or 'nothing'}, not Windows' own libraries alone")
    says_nothing_of_this_machine(file)
    print(f"   {file.name}: imports {', '.join(imports)}; {file.stat().st_size // 1000} kB")


def says_nothing_of_this_machine(file):
    content = file.read_bytes()
    for path in {tools.ROOT, tools.TARGET, tools.CARGO_HOME, Path.home(), tools.DEBIAN_SOURCES.resolve()}:
        at = content.find(f"{path}/".encode())
        if at >= 0:
            raise tools.Failed(f"{file} names {content[at : at + 120].split(bytes(1))[0].decode(errors='replace')}")
