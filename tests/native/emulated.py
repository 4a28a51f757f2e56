"""A run by a library for another system or processor, in an emulator."""

import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import pytest

from rotor_fmu.library.platforms import PLATFORMS

BITS = Path(__file__).with_name("bits.c")
ARM = "/usr/aarch64-linux-gnu"  # the C library of Debian's libc6-arm64-cross
# Debian's qemu-user, or qemu-user-static
QEMU = [shutil.which("qemu-aarch64") or "qemu-aarch64-static", "-L", ARM]


def need(emulator):
    """Skip a test whose emulator is missing."""
    if shutil.which(emulator[0]) is None:
        pytest.skip(f"{emulator[0]} is not installed")
    if ARM in emulator and not Path(ARM).is_dir():
        pytest.skip("libc6-arm64-cross is not installed")


def bits_of(library_file, folder, platform, emulator):
    """What a run of an unpacked FMU of FMI 2.0 computes, as hexadecimal text, a line a step."""
    description = fmpy.read_model_description(folder)
    computed = [v.valueReference for v in description.modelVariables if v.causality != "parameter"]
    first = str(next(r for r in computed if r > 20))
    last = str(max(computed) + 1)
    program = Path(folder) / f"bits-{platform}.exe"
    command = [sys.executable, "-m", "ziglang", "cc", "-target", PLATFORMS[platform].zig, "-O1"]
    subprocess.run([*command, "-o", program, BITS], check=True)
    arguments = [library_file, f"file://{folder}/resources", description.guid, first, last]
    done = subprocess.run([*emulator, program, *arguments], capture_output=True, check=True)
    return done.stdout.replace(b"\r", b"").decode()
