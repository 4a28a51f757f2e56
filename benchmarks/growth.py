"""How the cost of a step grows with the machine: more elements, more bearings."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.shaft import Section
from rotor_fmu.model.settings import choose

from .peers import exudyn_peer, project
from .problem import Diverged, Method, Missing, Problem, run_down, timed
from .store import Store

ELEMENTS = (7, 14, 28, 70, 140, 200)
BEARINGS = (2, 4, 6, 8, 10)
_BEARINGS_AT = 28  # elements of the machine that gets more bearings
_H = 1e-4  # [s]
_MODES = 4  # that `solver.reduction` keeps
REDUCED = f"{project.PROGRAM}, reduction = {_MODES}"
_EXUDYN_STOP, _STOP = 0.02, 1.0  # [s]
_EXUDYN_ELEMENTS = 70  # at most: it solves dense systems


def refined(rotor: Rotor, elements: int) -> Rotor:
    """The same rotor, of cylinders, in more elements, as even in length as its nodes allow."""
    lengths = np.diff(rotor.nodes)
    parts = np.ones(len(lengths), dtype=int)
    while parts.sum() < elements:
        parts[np.argmax(lengths / parts)] += 1
    moved = np.concatenate([[0], np.cumsum(parts)]) + 1

    def at(part):
        return replace(part, node=int(moved[part.node - 1])) if hasattr(part, "node") else part

    cut = [
        Section.cylinder(section.length / count, section.outer_left, section.material)
        for section, count in zip(rotor.sections, parts.tolist(), strict=True)
        for _ in range(count)
    ]
    return replace(rotor, sections=tuple(cut), parts=tuple(at(part) for part in rotor.parts))


def with_bearings(rotor: Rotor, count: int) -> Rotor:
    """The rotor on `count` bearings like its first, between its first and its last."""
    first, last = rotor.bearings[0], rotor.bearings[-1]
    nodes = np.linspace(first.node, last.node, count).round().astype(int)
    return rotor.with_parts(Bearing, *(replace(first, node=int(node)) for node in nodes))


def growth(
    store: Store, repetitions: int, is_quick: bool, report: Callable[[str, float], None]
) -> None:
    """Fill the section `growth`: elements, bearings, dofs, microseconds a step (each run's)."""
    rig = run_down().rotor
    machines = {f"{n} elements": refined(rig, n) for n in ELEMENTS[:: 3 if is_quick else 1]}
    dense = refined(rig, _BEARINGS_AT)
    for count in BEARINGS[:: 2 if is_quick else 1]:
        machines[f"{count} bearings"] = with_bearings(dense, count)
    for repetition in range(repetitions):
        for number, (name, rotor) in enumerate(machines.items()):
            for method in _methods():
                is_exudyn = method.program == exudyn_peer.PROGRAM
                if is_exudyn and len(rotor.sections) > _EXUDYN_ELEMENTS:
                    continue
                key = f"{method.program}, {name}"
                row = store.section("growth").get(key) or _row(method, name, rotor)
                if row["failed"] or len(row["us"]) > repetition:
                    continue
                share = (repetition * len(machines) + number) / (repetitions * len(machines))
                report(f"cost of a step: {key}", share)
                store.keep("growth", key, _measured(row, method, rotor))


def _methods() -> list[Method]:
    reduced = choose("robust", h=_H, reduction=_MODES)
    result = [
        project.method("robust", choose("robust", h=_H)),
        replace(project.method("reduced", reduced), program=REDUCED),
    ]
    try:
        exudyn_peer.load()
    except Missing:
        return result
    return [*result, exudyn_peer.method(0.2, _H)]


def _row(method: Method, name: str, rotor: Rotor) -> dict:
    return {
        "program": method.program,
        "varied": name.split()[1],
        "elements": len(rotor.sections),
        "bearings": len(rotor.bearings),
        "dofs": 4 * len(rotor.nodes) + 2 * len(rotor.bearings),
        "us": [],
        "failed": None,
    }


def _measured(row: dict, method: Method, rotor: Rotor) -> dict:
    stop = _EXUDYN_STOP if method.program == exudyn_peer.PROGRAM else _STOP
    problem = Problem("growth", rotor, stop, stop / 2)
    try:
        if not row["us"]:
            method.solve(replace(problem, stop=2 * _H, sample=_H))
        # matrices, equilibrium and modes are made once, and are not a step's cost
        start = timed(method.solve, replace(problem, stop=2 * _H, sample=_H))[0]
        seconds, result = timed(method.solve, problem)
    except Diverged as error:
        return {**row, "failed": str(error)}
    return {**row, "us": [*row["us"], 1e6 * (seconds - start) / (result.steps - 2)]}
