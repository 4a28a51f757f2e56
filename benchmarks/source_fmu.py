"""The FMU of C source in numbers: python -m benchmarks.source_fmu

What it holds, what the C compiler takes for it, and the rig's run-down with the library that it
makes over that with the native FMU's, in the same C master. Needs cc and wasm2c.
"""

import subprocess
import tempfile
import zipfile
from pathlib import Path

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_source

from .native_master import CMaster, children_cpu, median_ratio

COMPILE = ("cc", "-O1", "-shared", "-fPIC")
REPETITIONS = 5


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        master = CMaster(folder)
        fmu = build_source(folder, machine_of())
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder / "source")
        sources = sorted((folder / "source" / "sources").glob("*.c"))
        text = (folder / "source" / "sources" / "wasm_kernels.c").read_bytes()
        library, before = folder / "source.so", children_cpu()
        subprocess.run([*COMPILE, "-o", library, *sources, "-lm"], check=True)
        taken = children_cpu() - before
        ratio = median_ratio(
            REPETITIONS, lambda: master.run("rundown", library), lambda: master.run("rundown")
        )
        print("| | |\n| --- | ---: |")
        print(f"| the FMU | {fmu.stat().st_size / 1e6:.1f} MB |")
        lines = text.count(b"\n") // 1000
        print(f"| the C of the kernels in it, {lines} 000 lines | {len(text) / 1e6:.1f} MB |")
        print(f"| `{' '.join(COMPILE[:2])}` | {taken:.0f} s of CPU |")
        print(f"| the library | {library.stat().st_size / 1e6:.1f} MB |")
        print(f"| the rig's run-down, over the native library's time | {ratio:.2f} |")


if __name__ == "__main__":
    main()
