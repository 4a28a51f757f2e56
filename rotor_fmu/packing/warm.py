"""Compile the solver of an FMU ahead of its first use on a machine."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

import fmpy

from ..errors import InputError, RunFailed


def warm(fmu: Path) -> float:
    """Take an FMU through a step and its state there and back; returns the seconds that it took.

    Compiled code is kept in the user's cache folder by the content of the FMU's package, so every
    FMU of the same version of this project finds it, whatever its rotor. Raises `InputError` for
    what is no FMU, `RunFailed` for one that does not run.
    """
    try:
        description = fmpy.read_model_description(str(fmu))
    except Exception as error:  # FMPy raises whatever it met
        raise InputError(f"{fmu}: is no FMU: {error}") from error
    folder = fmpy.extract(str(fmu))
    begun = time.perf_counter()
    try:
        instance = fmpy.instantiate_fmu(folder, description, "CoSimulation")
        instance.setupExperiment(startTime=0.0)
        instance.enterInitializationMode()
        instance.exitInitializationMode()
        state = instance.getFMUstate()
        instance.doStep(0.0, 1e-3)
        instance.setFMUstate(state)
        instance.freeFMUstate(state)
        instance.terminate()
        instance.freeInstance()
    except Exception as error:
        raise RunFailed(f"{fmu}: {error}") from error
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return time.perf_counter() - begun
