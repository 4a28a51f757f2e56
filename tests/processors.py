"""The tests as other processors would run them, and on loaded cores: make test-processors.

OpenBLAS and numba are told to take another processor for this one. Each setting has a cache of its
own. Arguments go to pytest. The exit status is the number of settings under which a test failed.
"""

import os
import subprocess
import sys
import tempfile
import time

SETTINGS = {
    "Prescott": {"OPENBLAS_CORETYPE": "Prescott"},
    "Haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "SkylakeX": {"OPENBLAS_CORETYPE": "SkylakeX"},
    "generic": {"NUMBA_CPU_NAME": "generic"},
    "loaded": {},
}
BUSY = [sys.executable, "-c", "while True: pass"]
PYTEST = [sys.executable, "-m", "pytest", "-n", "auto", "--dist", "loadfile"]
EVERY = ["-m", "slow or not slow"]


def passes(name, arguments):
    """Whether all tests pass under a setting, which is told with what it took."""
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


if __name__ == "__main__":
    arguments = sys.argv[1:] or EVERY
    sys.exit(sum(not passes(name, arguments) for name in SETTINGS))
