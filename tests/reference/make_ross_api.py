"""What ROSS says of the machines of `make_ross.py` by its analyses for API 617 and 684.

    python -m venv v && v/bin/pip install "ross-rotordynamics==2.3.0" "plotly<7"
    v/bin/python tests/reference/make_ross_api.py

Writes ross_api_answers.json beside this file.
"""

import json
import math

import numpy as np
import ross as rs
from make_ross import HERE, MACHINES
from scipy.optimize import brentq, minimize_scalar

STIFFNESSES = 7  # from 1e6 to 1e9 N/m
SPEED = 900.0  # rad/s, one of the table of the bearings
NODE = 3  # of the cross coupling, from 0
COUPLINGS = {"compressor.toml": 8e7, "on_pedestals.json": 2e5, "under_tension.toml": 5e4}
# machine: probe (from 0), where its peaks are looked for [rad/s]. The compressor has none: between
# the speeds of its tables ROSS 2.3 has other coefficients than this project (splines, not PCHIP).
PEAKS = {
    "on_pedestals.json": (3, ((335.0, 350.0), (1050.0, 1130.0))),
    "under_tension.toml": (4, ((86.0, 92.0), (80.0, 87.0))),
}


def critical_maps(rotor):
    """Lines of the map at standstill and of synchronous critical speeds [rad/s]."""
    result = {}
    for synchronous in (False, True):
        found = rotor.run_ucs(
            stiffness_range=(6, 9), num=STIFFNESSES, num_modes=16, synchronous=synchronous
        )
        result["synchronous" if synchronous else "at rest"] = found.wn.tolist()
    return result


def level_1(rotor, most):
    """Logarithmic decrement of the first forward mode over the cross coupling; on pedestals ROSS
    loses the masses in `run_level1`, so that the same is done here by its `run_modal`."""
    values = np.linspace(0.0, most, 6)[1:]
    rotor.rated_w = SPEED
    try:
        found = rotor.run_level1(n=NODE, stiffness_range=(values[0], values[-1]), num=len(values))
        return values.tolist(), found.log_dec.tolist(), "run_level1"
    except ValueError:
        log_dec = []
        for q in values:
            coupled = rs.BearingElement(n=NODE, kxx=0, cxx=0, kxy=q, kyx=-q)
            other = rs.Rotor(
                rotor.shaft_elements,
                rotor.disk_elements,
                [*rotor.bearing_elements, coupled],
                rotor.point_mass_elements,
            )
            modal = other.run_modal(SPEED)
            log_dec.append(modal.log_dec[modal.whirl_direction() != "Backward"][0])
        return values.tolist(), log_dec, "run_modal"


def peaks(rotor, unbalances, node, windows):
    """Critical speeds [rad/s] and amplification factors of both axes, by API 684, from responses
    that ROSS computes at any speed."""
    nodes, amounts, phases = (list(item) for item in zip(*unbalances, strict=True))
    known = {}

    def amplitude(speed, axis):
        if speed not in known:
            found = rotor.run_unbalance_response(
                nodes, amounts, phases, frequency=np.array([speed])
            )
            at = rotor.number_dof * node
            known[speed] = np.abs(found.forced_resp[at : at + 2, 0])
        return known[speed][axis]

    result = []
    for axis in (0, 1):
        for low, high in windows:
            top = minimize_scalar(
                lambda s, a=axis: -amplitude(s, a),
                bounds=(low, high),
                method="bounded",
                options={"xatol": 1e-9 * low},
            )
            speed, half = top.x, -math.sqrt(0.5) * top.fun
            if min(speed - low, high - speed) < 1e-3 * (high - low):
                continue
            ends = []
            for step in (-1e-4, 1e-4):
                at = speed
                while amplitude(at, axis) > half:
                    at *= 1 + step
                    step *= 1.3
                ends.append(brentq(lambda s, a=axis, h=half: amplitude(s, a) - h, speed, at))
            factor = speed / (ends[1] - ends[0])
            result.append({"axis": "xy"[axis], "speed": speed, "factor": factor})
    return result


def main():
    """Write the numbers."""
    answers = {}
    for file, (build, *unbalances) in MACHINES.items():
        rotor = build()
        answers[file] = {"ross_version": rs.__version__, "critical_map": critical_maps(rotor)}
        names = ("stiffness", "log_dec", "analysis")
        level = level_1(build(), COUPLINGS[file])
        answers[file]["level_1"] = dict(zip(names, level, strict=True))
        if file in PEAKS:
            node, windows = PEAKS[file]
            found = peaks(rotor, unbalances, node, windows)
            answers[file]["peaks"] = {"node": node, "unbalances": unbalances, "found": found}
    (HERE / "ross_api_answers.json").write_text(json.dumps(answers, indent=1) + "\n")


if __name__ == "__main__":
    main()
