"""The library inside an FMU, as the dynamic linker sees it."""

import ctypes
import os
import re
from pathlib import Path

import fmpy
import pytest

HEADER = Path(fmpy.__file__).parent / "c-code" / "fmi2Functions.h"
EXPORT = re.compile(r"FMI2_Export\s+fmi2\w+TYPE\s+(fmi2\w+);")


def functions():
    """The functions of the standard's header: common and co-simulation, and model exchange."""
    text = HEADER.read_text()
    # The sections appear twice: names for a prefix come first, the exports after them.
    text = text[text.index("FMI2_Export fmi2") :]
    exchange = text.index("Functions for FMI2 for Model Exchange")
    co_simulation = text.index("Functions for FMI2 for Co-Simulation")
    assert exchange < co_simulation
    wanted = EXPORT.findall(text[:exchange]) + EXPORT.findall(text[co_simulation:])
    return wanted, EXPORT.findall(text[exchange:co_simulation])


@pytest.fixture
def library(unpacked):
    # RTLD_NOW: an undefined symbol fails here, not in the call that needs it.
    return ctypes.CDLL(str(unpacked("set1").library), mode=os.RTLD_NOW | os.RTLD_LOCAL)


def test_all_common_and_co_simulation_functions_are_exported(library):
    wanted, _ = functions()
    # 25 common ones and 9 of co-simulation: the header was read right.
    assert len(wanted) == 34
    assert [name for name in wanted if not hasattr(library, name)] == []


def test_no_function_of_model_exchange_is_exported(library):
    _, exchange = functions()
    assert len(exchange) == 10
    assert [name for name in exchange if hasattr(library, name)] == []


def test_version_and_platform_are_those_of_fmi_2_0(library):
    for name, value in [("fmi2GetVersion", b"2.0"), ("fmi2GetTypesPlatform", b"default")]:
        function = getattr(library, name)
        function.restype = ctypes.c_char_p
        assert function() == value
