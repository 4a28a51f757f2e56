"""Tests: laws of physics, closed forms and other programs' numbers first."""

import os

# before NumPy loads: pytest-xdist fills the cores, more threads would wait for each other
for _library in ("OPENBLAS", "OMP", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")
