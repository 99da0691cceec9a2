"""The import of the module."""

import subprocess
import sys
import time


def test_an_import_is_fast_and_leaves_numpy_alone():
    def seconds(code):
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True)
        return time.perf_counter() - begin

    check = "import amontons, sys; assert 'numpy' not in sys.modules and 'xarray' not in sys.modules"
    assert min(seconds(check) for _ in range(5)) - min(seconds("pass") for _ in range(5)) < 0.1
