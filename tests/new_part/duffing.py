"""For `tests.periodic.test_duffing`, in a copy of the package that knows a cubic spring: of each
question, its file, options of `rf.response` and speeds, the folds [rad/s] with the displacements
and velocities of the disc at the mark, and the motions at the speeds."""

import json
import sys

import numpy as np

import rotor_fmu as rf


def start(result, point):
    """x, y [m] and their rates [m/s] of the disc at the mark, its 1x phase, and the harmonics."""
    X = result._amplitudes(point, "disc")
    k = 1j * point.orbit.omega * np.arange(len(X))[:, None]
    state = np.concatenate([X.sum(axis=0).real, (k * X).sum(axis=0).real])
    return {
        "state": state.tolist(),
        "r": result.amplitude(point, "disc"),
        "phase": result.amplitude(point, "disc", "x_1x_phase"),
        "stable": point.is_stable,
        "H": point.orbit.H,
    }


answers = []
for question in json.loads(sys.argv[1]):
    found = rf.response(question["file"], speed=tuple(question["range"]), **question["options"])
    folds = []
    for branch in found.branches:
        for b in branch.bifurcations:
            if b.kind == "fold":
                near = branch.points[b.behind]
                folds.append({"speed": b.value, "H": b.orbit.H, **start(found, near)})
    motions = {speed: [start(found, p) for p in found.at(speed)] for speed in question["at"]}
    answers.append({"folds": folds, "motions": motions})
print(json.dumps(answers))
