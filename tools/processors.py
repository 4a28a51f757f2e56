"""The tests as other processors would run them, and on loaded cores: make test-processors.

OpenBLAS and numba are made to take another processor for this one. Each setting has a cache of its
own. Arguments go to pytest. Stopped with Ctrl-C it goes on from there: settings that this very tree
has passed are not run again. The exit status is the number of settings under which a test failed.
"""

import hashlib
import json
import os
import subprocess
import sys
import tempfile
import time

from .checkout import ROOT, names

SETTINGS = {
    "Prescott": {"OPENBLAS_CORETYPE": "Prescott"},
    "Haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "SkylakeX": {"OPENBLAS_CORETYPE": "SkylakeX"},
    # numba compiles, where the library made beforehand would be taken
    "generic": {
        "NUMBA_CPU_NAME": "generic",
        "NUMBA_CPU_FEATURES": "",
        "ROTOR_FMU_KERNELS": "numba",
    },
    "loaded": {},
}
BUSY = [sys.executable, "-c", "while True: pass"]
PYTEST = [sys.executable, "-m", "pytest", "-n", "auto", "--dist", "loadfile"]
EVERY = ["-m", "slow or not slow"]
PASSED = ROOT / "build" / "processors.json"


def tree(arguments):
    """What is tested: the files as they are now, and pytest's arguments."""
    content = hashlib.sha256(repr(arguments).encode())
    for name in sorted(names()):
        content.update(f"{name}\0".encode() + (ROOT / name).read_bytes())
    return content.hexdigest()


def passed(of_tree):
    """Names of the settings that this tree has passed."""
    if not PASSED.is_file():
        return []
    described = json.loads(PASSED.read_text())
    return described["passed"] if described["tree"] == of_tree else []


def passes(name, arguments):
    """Whether all tests pass under a setting, and print that with what it took."""
    print(f"== {name}", flush=True)
    begun = time.perf_counter()
    others = [subprocess.Popen(BUSY) for _ in range(os.cpu_count() if name == "loaded" else 0)]
    try:
        with tempfile.TemporaryDirectory(prefix="rotor_fmu_cache_") as cache:
            environment = {**os.environ, **SETTINGS[name], "ROTOR_FMU_CACHE": cache}
            status = subprocess.run([*PYTEST, *arguments], env=environment, check=False).returncode
    finally:
        for other in others:
            other.kill()
            other.wait()
    verdict = "passed" if status == 0 else f"failed, status {status}"
    print(f"== {name}: {verdict} after {(time.perf_counter() - begun) / 60:.0f} min", flush=True)
    return status == 0


def main(arguments):
    """Run the settings that are left; the number of those that failed."""
    here = tree(arguments)
    done = passed(here)
    failed = 0
    for name in SETTINGS:
        if name in done:
            print(f"== {name}: passed before", flush=True)
        elif passes(name, arguments):
            done = [*done, name]
            PASSED.parent.mkdir(exist_ok=True)
            PASSED.write_text(json.dumps({"tree": here, "passed": done}))
        else:
            failed += 1
    return failed


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:] or EVERY))
    except KeyboardInterrupt:
        sys.exit(130)
