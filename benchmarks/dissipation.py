"""Which high-frequency dissipation serves best: spectral radii in fixed steps."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from rotor_fmu.model.settings import choose

from .peers import project
from .problem import run_down
from .store import Store

RADII = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8)
STEPS = (5e-4, 2.5e-4)  # [s]


def dissipation(store: Store, is_quick: bool, report: Callable[[str, float], None]) -> None:
    """Fill the section `dissipation`: rho, h [s], largest error of the orbit [m]; needs the
    reference that the race keeps."""
    stored = store.section("reference")["run-down"]
    truth = np.array(stored["x"]) + 1j * np.array(stored["y"])
    problem = replace(run_down(), stop=stored["stop"])
    for number, rho in enumerate(RADII[:: 4 if is_quick else 1]):
        for h in STEPS:
            name = f"rho = {rho:g}, h = {h:g} s"
            if name in store.section("dissipation"):
                continue
            report(f"dissipation: {name}", number / len(RADII))
            result = project.solve(choose("robust", rho=rho, h=h), problem)
            error = float(np.abs(result.disc - truth).max())
            store.keep("dissipation", name, {"rho": rho, "h": h, "orbit_max": error})
