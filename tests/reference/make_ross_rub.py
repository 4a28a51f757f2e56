"""A rub that ROSS 2.3.0 integrated, which writes ross_rub.json and ross/rubbing.toml beside this
file; installed as make_ross.py says.

    v/bin/python tests/reference/make_ross_rub.py

An unbalanced rotor, from rest, against a wall without friction and damping: of these ROSS' model is
another one. Its Newmark method takes the force of the contact from the step before, so that its
error falls with the step; the orbits of two steps are extrapolated.
"""

import json
from pathlib import Path

import numpy as np
import ross as rs

HERE = Path(__file__).parent
STOP, SAMPLED = 0.3, 2e-3  # [s]
STEP = 1.25e-5  # and half of it [s]
SPEED = 125.0  # [rad/s]
CONTACT = {"node": 13, "clearance": 8e-5, "k": 1.1e6}
UNBALANCE = {"node": 13, "amount": 8e-4, "phase": -1.5}


def rotor():
    """A shaft with two discs, damped by its mass and its stiffness."""
    shaft = [
        rs.ShaftElement(0.025, 0.0, 0.019, material=rs.materials.steel, n=n, alpha=8.0, beta=1e-5)
        for n in range(32)
    ]
    discs = [rs.DiskElement(n=n, m=2.6, Id=0.004, Ip=0.007) for n in (12, 20)]
    bearings = [rs.BearingElement(n=n, kxx=8.5e5, kyy=1.2e6, cxx=8e2, cyy=1.2e3) for n in (2, 30)]
    return rs.Rotor(shaft, discs, bearings)


def orbit(machine, step):
    """x + i y of the node at the contact [m], every SAMPLED."""
    node = CONTACT["node"] - 1
    result = machine.run_rubbing(
        n=node,
        distance=CONTACT["clearance"],
        contact_stiffness=CONTACT["k"],
        contact_damping=0.0,
        friction_coeff=0.0,
        node=[UNBALANCE["node"] - 1],
        unbalance_magnitude=[UNBALANCE["amount"]],
        unbalance_phase=[UNBALANCE["phase"]],
        speed=SPEED,
        t=np.arange(round(STOP / step) + 1) * step,
    )
    at = machine.number_dof * node
    rows = result.yout[:: round(SAMPLED / step)]
    return rows[:, at] + 1j * rows[:, at + 1]


def main():
    """Write the machine and its orbit."""
    machine = rotor()
    path = HERE / "ross" / "rubbing.toml"
    path.unlink(missing_ok=True)
    machine.save(path)
    coarse, fine = (orbit(machine, step) for step in (STEP, STEP / 2))
    z = 2 * fine - coarse
    answer = {
        "ross_version": rs.__version__,
        "contact": CONTACT,
        "unbalance": UNBALANCE,
        "speed": SPEED,
        "sampled": SAMPLED,
        "error": float(np.abs(fine - coarse).max()),
        "x": z.real.tolist(),
        "y": z.imag.tolist(),
    }
    (HERE / "ross_rub.json").write_text(json.dumps(answer) + "\n")


if __name__ == "__main__":
    main()
