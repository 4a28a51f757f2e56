"""The block of memory of a run: which named tuples lie in it, and its layout."""

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.block import Layout
from ..schemes.family import Scheme
from ..stability.survey_block import WhirlSurvey, coarse_shaft
from ..step.interface_problem import InterfaceProblem
from ..step.laws import MOST_LOSSES
from ..step.stages import Stages
from ..step.step import Motion, Workspace
from ..step.tangent import Tangent, TangentWork
from ..structure.ledger import FLOWS, STORES
from ..structure.structure import Structure, sizes_of, starts_of
from ..warnings import RUN_WARNINGS
from .control import Control
from .memory import Memory
from .recorder import Recorder

_INTEGERS = ("mode", "indicator", "norm", "is_fitted", "stages", "newton_limit")
# What is found out during a run stands in its memory instead.
_SETTINGS = tuple(n for n in Control._fields if n not in Control._field_defaults)
METHOD = np.dtype(
    [(n, "f8") for n in Scheme._fields] + [(n, "i8" if n in _INTEGERS else "f8") for n in _SETTINGS]
)


class Integrator(NamedTuple):
    """The integrator and its step control: one record of the numbers of `Scheme` and `Control`."""

    numbers: Annotated[np.recarray, METHOD, "1"]


class OutputArrays(NamedTuple):
    """The quantities of `observe.observed`; scratch and result of `derivatives`."""

    observed: Annotated[np.ndarray, float, "outputs"]
    at: Annotated[np.ndarray, float, "outputs"]
    derivatives: Annotated[np.ndarray, float, "2", "outputs"]


class RunData(NamedTuple):
    """All arrays of a run. `motion` and `memory` are its state, and `tangent` if sensitivities are
    computed; the arrays before them belong to the machine, those behind are work arrays that every
    call fills anew."""

    structure: Structure
    method: Integrator
    motion: Motion
    memory: Memory
    tangent: Tangent
    trial: Motion
    work: Workspace
    problem: InterfaceProblem
    stages: Stages
    outputs: OutputArrays
    recorder: Recorder
    survey: WhirlSurvey
    tangent_after: Tangent
    tangent_work: TangentWork
    moved: Motion


LAYOUT = Layout(RunData)


def new_block(
    structure: Structure, outputs: int, channels: int = 0, recorder_rows: int = 0
) -> np.ndarray:
    """Return a block for runs of a machine, its structure copied in; outputs: number of observed
    quantities; channels, recorder_rows (even): of the recorder."""
    shaft = coarse_shaft(structure)
    sizes = sizes_of(structure) | {
        "all_stores": len(STORES),
        "flows": len(FLOWS),
        "most_losses": MOST_LOSSES,
        "outputs": outputs,
        "channels": channels,
        "recorder_rows": recorder_rows,
        "basis": shaft.basis.shape[1],
        "coarse": len(shaft.mass),
        "coarse_width": shaft.mass.shape[1],
        "single_contacts": len(shaft.single_contact_basis),
        "single_contact_dofs": shaft.single_contact_basis.shape[2],
    }
    block = LAYOUT.new(sizes)
    run = LAYOUT.view_in_python(block)
    for field, value in zip(run.structure, structure, strict=True):
        pairs = zip(field, value, strict=True) if isinstance(value, tuple) else [(field, value)]
        for target, source in pairs:
            target[...] = source
    run.motion.internal_state[...] = starts_of(run.structure.interfaces)
    for warning in RUN_WARNINGS:
        run.memory.record[0][warning.since] = np.nan
    for name, value in Control._field_defaults.items():
        run.memory.record[0][name] = value
    for name, values in shaft._asdict().items():
        getattr(run.survey, name)[...] = values
    run.memory.record[0].damping = 1.0
    run.work.key[:] = np.nan
    run.stages.key[:] = np.nan
    return block
