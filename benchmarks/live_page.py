"""The page on which the rig runs, in numbers: python -m benchmarks.live_page

Its size, and how long a browser takes to its first picture and for its run-down, over the native
FMU's run-down in a C master. Needs selenium, chromium, chromedriver and cc.
"""

import statistics
import tempfile
import time
import zlib
from pathlib import Path
from typing import Any

from rotor_fmu.files import write_text
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.library.build import library
from rotor_fmu.library.platforms import WASM
from rotor_fmu.live.live_page import solver_page

from .browser import PATIENCE, browser
from .native_master import CMaster

REPETITIONS = 5
DRAWN = "return typeof now === 'object' && now?.isDrawn ? performance.now() : null"
ENDED = "return document.documentElement.dataset.runs ? [now.seconds, now.n] : null"


def main() -> None:
    with tempfile.TemporaryDirectory() as name, browser() as driver:
        master, page = CMaster(Path(name)), Path(name) / "page.html"
        write_text(solver_page(machine_of()), page)

        def waited(script: str) -> Any:
            end = time.monotonic() + PATIENCE
            while (answer := driver.execute_script(script)) is None:
                if time.monotonic() > end:
                    raise TimeoutError(f"{page} does not run within {PATIENCE:g} s")
                time.sleep(0.01)
            return answer

        drawn, seconds, ratios, samples = [], [], [], 0
        for _ in range(REPETITIONS):
            driver.get(page.as_uri())
            drawn.append(waited(DRAWN) / 1e3)
            taken, samples = waited(ENDED)
            seconds.append(taken)
            ratios.append(taken / master.run("rundown"))
        packed = len(zlib.compress(library(WASM).read_bytes(), 9)) / 1e6
        print("| | |\n| --- | ---: |")
        print(f"| page of the rig | {page.stat().st_size / 1e6:.2f} MB |")
        print(f"| solver library for a page, packed | {packed:.2f} MB |")
        print(f"| first picture after the page is opened | {statistics.median(drawn):.2f} s |")
        print(
            f"| run-down of 40 s at the FMU's tolerance, {samples} samples, drawn as it goes "
            f"| {statistics.median(seconds):.1f} s |"
        )
        print(f"| the same over the native FMU's CPU time | {statistics.median(ratios):.1f} |")


if __name__ == "__main__":
    main()
