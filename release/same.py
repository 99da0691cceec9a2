"""That the programs for Linux and for Windows make the same FMUs, byte for byte; Windows' runs through wine."""

import os
import shutil
import tempfile
from pathlib import Path

import build
import tools

# One for each thing that a page draws or a library computes.
SCENES = ["set1", "set2", "ring12", "belt", "den_hartog", "hoffmann", "disc_brake", "drive"]
# Debian has wine64 beside the path.
PATH = f"{os.environ['PATH']}{os.pathsep}/usr/lib/wine"


def check():
    if not shutil.which("wine64", path=PATH):
        print("   not compared: there is no wine64")
        return
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        wine = {"PATH": PATH, "WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all"}
        # Neither a browser nor .NET is wanted: wine would offer to install them.
        wine |= {"WINEDLLOVERRIDES": "mscoree=;mshtml=", "SOURCE_DATE_EPOCH": None}
        tools.run(["wine64", "wineboot", "--init"], **wine)
        # What wine 8 lacks (crates/cli/tests/importers/platforms.rs).
        stub = folder / "wine/drive_c/windows/system32/bcryptprimitives.dll"
        source = tools.ROOT / "crates/cli/tests/platforms/bcryptprimitives.c"
        tools.run([f"{tools.MINGW}gcc", "-shared", "-O1", "-o", stub, source])
        for scene in SCENES:
            linux, windows = folder / "linux.fmu", folder / "windows.fmu"
            export = ["export", scene, "-o"]
            tools.run([build.linux_program(), *export, linux], stdout=folder / "said", SOURCE_DATE_EPOCH=None)
            # wine has this system's files on its drive Z.
            tools.run(["wine64", build.windows_program(), *export, f"Z:{windows}"], stdout=folder / "said", **wine)
            if linux.read_bytes() != windows.read_bytes():
                raise tools.Failed(f"the FMU of {scene} is not the same from the programs for Linux and for Windows")
        tools.run(["wineserver64", "-k"], **wine)
    print(f"   the same: {', '.join(SCENES)}")
