"""Machines in ROSS, saved as it saves them, with its own numbers about them.

    python -m venv v && v/bin/pip install "ross-rotordynamics==2.3.0" "plotly<7"
    v/bin/python tests/reference/make_ross.py

and with 3.1.0 on Python 3.13 in the same way. Writes ross/*.toml, ross/*.json and ross_answers.json
beside this file, of ROSS 3 ross3/... and ross3_answers.json.
"""

import json
import math
from functools import partial
from pathlib import Path

import numpy as np
import ross as rs

HERE = Path(__file__).parent
IS_3 = rs.__version__.startswith("3")
FOLDER = "ross3" if IS_3 else "ross"
STEEL = rs.Material("steel", rho=7810.0, E=211e9, G_s=81.2e9)
TITANIUM = rs.Material("titanium", rho=4430.0, E=114e9, G_s=43e9)


def compressor():
    """Hollow, tapered, two materials in layers, bearings with tables over the speed, a seal."""
    shaft = [
        rs.ShaftElement(0.06, 0.0, 0.06, material=STEEL, n=0),
        rs.ShaftElement(0.10, 0.01, 0.06, 0.02, 0.09, material=STEEL, n=1),
        rs.ShaftElement(0.12, 0.02, 0.09, material=STEEL, n=2),
        rs.ShaftElement(0.12, 0.09, 0.12, material=TITANIUM, n=2),
        rs.ShaftElement(0.12, 0.02, 0.09, material=STEEL, n=3),
        rs.ShaftElement(0.12, 0.09, 0.12, 0.09, 0.10, material=TITANIUM, n=3),
        rs.ShaftElement(0.10, 0.02, 0.09, 0.0, 0.05, material=STEEL, n=4),
        rs.ShaftElement(0.08, 0.0, 0.05, material=TITANIUM, n=5),
    ]
    discs = [
        rs.DiskElement.from_geometry(2, STEEL, 0.04, 0.12, 0.30),
        rs.DiskElement(n=4, m=12.0, Id=0.08, Ip=0.13),
    ]
    speed = np.array([0.0, 200.0, 500.0, 900.0, 1500.0])
    rise = speed / 1500
    bearings = [
        rs.BearingElement(
            n=n,
            kxx=scale * (4e7 + 2e7 * rise),
            kyy=scale * (6e7 + 3e7 * rise**2),
            kxy=scale * (8e6 * rise),
            kyx=-scale * (1.2e7 * rise),
            cxx=scale * (6e4 - 2e4 * rise),
            cyy=scale * (9e4 - 4e4 * rise),
            cxy=scale * 4e3 * rise,
            cyx=scale * 3e3 * rise,
            **{"speed" if IS_3 else "frequency": speed},
            tag=f"bearing {n}",
        )
        for n, scale in ((0, 1.0), (5, 0.8))
    ]
    seal = rs.SealElement(
        n=3,
        kxx=2e6,
        kxy=5e6,
        kyx=-5e6,
        kyy=2e6,
        cxx=3e3,
        cxy=400.0,
        cyx=-400.0,
        cyy=3e3,
        tag="balance piston",
    )
    return rs.Rotor(shaft, discs, [*bearings, seal])


def on_pedestals():
    """Bearings on pedestals with mass, Hutchinson's coefficient."""
    shaft = [
        rs.ShaftElement(0.1, 0.0, 0.05, material=STEEL, n=n, shear_method_calc="hutchinson")
        for n in range(10)
    ]
    discs = [rs.DiskElement.from_geometry(n, STEEL, 0.05, 0.05, 0.3) for n in (3, 6)]
    bearings = [
        rs.BearingElement(n=1, n_link=11, kxx=2e7, kyy=3e7, cxx=2e3, cyy=3e3, kxy=1e6, kyx=-2e6),
        rs.BearingElement(n=9, n_link=12, kxx=2e7, kyy=3e7, cxx=2e3, cyy=3e3),
        rs.BearingElement(n=11, kxx=5e7, kyy=8e7, cxx=500.0, cyy=800.0),
        rs.BearingElement(n=12, kxx=6e7, kyy=9e7, cxx=600.0, cyy=900.0),
    ]
    masses = [
        rs.PointMass(n=11, m=15.0),
        rs.PointMass(n=12, m=12.0),
    ]
    return rs.Rotor(shaft, discs, bearings, masses)


def under_tension():
    """Anisotropic damped supports, a shaft under tension."""
    shaft = [
        rs.ShaftElement(1.5 / 12, 0.0, 0.05, material=STEEL, n=n, axial_force=2e4)
        for n in range(12)
    ]
    discs = [
        rs.DiskElement.from_geometry(4, STEEL, 0.07, 0.05, 0.28),
        rs.DiskElement.from_geometry(8, STEEL, 0.07, 0.05, 0.35),
    ]
    bearings = [rs.BearingElement(n=n, kxx=1e6, kyy=8e5, cxx=300.0, cyy=500.0) for n in (0, 12)]
    return rs.Rotor(shaft, discs, bearings)


def damped_by_its_mass():
    """Rayleigh's damping of the shaft, by its mass and its stiffness, with a heavy disc."""
    shaft = [
        rs.ShaftElement(0.1, 0.0, 0.05, material=STEEL, n=n, alpha=8.0, beta=1e-5) for n in range(8)
    ]
    discs = [rs.DiskElement.from_geometry(3, STEEL, 0.07, 0.05, 0.3)]
    bearings = [rs.BearingElement(n=n, kxx=1e7, kyy=2e7, cxx=100.0) for n in (0, 8)]
    return rs.Rotor(shaft, discs, bearings)


def pump():
    """Two liquid seals with cross coupling and added mass."""
    shaft = [rs.ShaftElement(0.15, 0.0, 0.06, material=STEEL, n=n) for n in range(6)]
    discs = [rs.DiskElement(n=n, m=18.0, Id=0.09, Ip=0.16) for n in (2, 4)]
    bearings = [rs.BearingElement(n=n, kxx=4e7, kyy=6e7, cxx=4e4, cyy=6e4) for n in (0, 6)]
    seals = [
        rs.SealElement(
            n=n,
            kxx=3e6,
            kyy=3e6,
            kxy=4e6,
            kyx=-4e6,
            cxx=2e4,
            cyy=2e4,
            cxy=900.0,
            cyx=-900.0,
            mxx=mass,
            myy=mass,
            tag=f"seal {n}",
        )
        for n, mass in ((2, 6.0), (3, 25.0))
    ]
    return rs.Rotor(shaft, discs, [*bearings, *seals])


def computed_bearings():
    """Bearings that ROSS computed: a ball bearing, and a film over the speed."""
    shaft = [rs.ShaftElement(0.125, 0.0, 0.05, material=STEEL, n=n) for n in range(8)]
    discs = [rs.DiskElement(n=3, m=15.0, Id=0.1, Ip=0.2)]
    speed = np.array([200.0, 500.0, 900.0, 1500.0])
    bearings = [
        rs.BallBearingElement(n=0, n_balls=8, d_balls=0.03, fs=500.0, alpha=np.pi / 6, tag="ball"),
        rs.CylindricalBearing(
            n=8,
            speed=speed,
            weight=150.0,
            bearing_length=0.03,
            journal_diameter=0.05,
            radial_clearance=5e-5,
            oil_viscosity=0.02,
            tag="film",
        ),
    ]
    return rs.Rotor(shaft, discs, bearings)


def at_random(seed):
    """All that is imported, drawn at random."""
    random = np.random.default_rng(seed)
    count, thick = int(random.integers(3, 7)), random.uniform(0.03, 0.1)
    alpha, beta = random.uniform(0, 10), random.uniform(0, 2e-5)
    shaft, right, bore = [], thick, 0.0
    for n in range(count):
        left, right = right, thick * random.uniform(0.7, 1.2)
        bore = 0.4 * min(left, right) * random.choice([0.0, random.random()])
        keys = {
            "n": n,
            "material": [STEEL, TITANIUM][random.integers(2)],
            "shear_method_calc": str(random.choice(["cowper", "hutchinson"])),
            "alpha": alpha,
            "beta": beta,
        }
        length = thick * random.uniform(1, 4)
        shaft.append(rs.ShaftElement(length, bore, left, 0.8 * bore, right, **keys))
        if random.random() < 0.3:
            sleeve = thick * random.uniform(1.3, 1.6)
            shaft.append(rs.ShaftElement(length, left, sleeve, right, sleeve, **keys))
    discs = []
    for n in random.integers(0, count + 1, 2):
        mass, radius = random.uniform(5, 50) * (thick / 0.05) ** 3, thick * random.uniform(1, 4)
        Ip = mass * radius**2 / 2
        discs.append(rs.DiskElement(n=int(n), m=mass, Id=Ip * random.uniform(0.5, 1.5), Ip=Ip))
    speed = np.array([0.0, 200.0, 500.0, 900.0, 1500.0])
    bearings, pedestals = [], []

    def of(kind, n, stiffness, has_table, **others):
        """Return what holds, its coefficients of all kinds, over the speed where it has a table."""
        rise = speed / 1500 if has_table else 0.0
        scales = {"kxx": 1, "kyy": 1, "kxy": 0.2, "kyx": -0.2}
        scales |= {"cxx": 1e-3, "cyy": 1e-3, "cxy": 1e-4, "cyx": 1e-4}
        values = {
            name: stiffness * scale * (random.uniform(0.5, 2) + random.uniform(-0.3, 0.3) * rise)
            for name, scale in scales.items()
        }
        if has_table:
            values["frequency"] = speed
        return kind(n=int(n), tag=f"{kind.__name__} {len(bearings)}", **values, **others)

    for n in (0, count):
        stiffness = 10 ** random.uniform(6, 8)
        if random.random() < 0.4:
            link = count + 1 + len(pedestals)
            bearings.append(of(rs.BearingElement, n, stiffness, True, n_link=link))
            bearings.append(
                rs.BearingElement(n=link, kxx=3 * stiffness, kyy=4 * stiffness, cxx=500.0, cyy=80.0)
            )
            pedestals.append(rs.PointMass(n=link, m=random.uniform(5, 50)))
        else:
            bearings.append(of(rs.BearingElement, n, stiffness, random.random() < 0.5))
    bearings.append(of(rs.SealElement, random.integers(1, count), 1e5, False))
    return rs.Rotor(shaft, discs, bearings, pedestals)


MACHINES = {
    "compressor.toml": (compressor, (2, 1e-4, 0.3), (4, 2e-4, 2.0)),
    "on_pedestals.json": (on_pedestals, (3, 1e-4, 0.0), (6, 1e-4, 1.0)),
    "under_tension.toml": (under_tension, (4, 1e-4, -0.5), (8, 5e-5, 0.0)),
}
if not IS_3:
    MACHINES["damped_by_its_mass.toml"] = (damped_by_its_mass, (3, 1e-4, 0.0), (6, 5e-5, 1.0))
    for seed in range(8):
        node = 1 + seed % 3
        MACHINES[f"random_{seed}.json"] = (partial(at_random, seed), (node, 1e-4, 0.1 * seed))
    MACHINES["pump.toml"] = (pump, (2, 1e-4, 0.0), (4, 1e-4, 1.5))
    MACHINES["computed_bearings.toml"] = (computed_bearings, (3, 1e-4, 0.0), (5, 5e-5, 1.0))
NOT_AT_REST = {"computed_bearings.toml"}  # whose film has no coefficients there
# those of the tables: between them ROSS 2.3 has splines where ROSS 3 and this project have PCHIP
BETWEEN = (350.0, 1200.0) if IS_3 else ()
SPEEDS = (0.0, 200.0, 500.0, 900.0, *BETWEEN)
RESPONSES = (200.0, 500.0, 900.0, 1500.0, *BETWEEN)


def lateral(rotor, speed):
    """Natural frequencies [rad/s] and logarithmic decrements without modes along the axis and of
    torsion, of which the matrices here have none."""
    shaft = 6 * (
        max(e.n for e in rotor.shaft_elements) + 2
    )  # behind them the nodes of pedestals, x y z
    keep = [i for i in range(shaft) if i % 6 in (0, 1, 3, 4)]
    stiffness = rotor.K(speed)
    keep += [i for i in range(shaft, rotor.ndof) if (i - shaft) % 3 < 2 and stiffness[i].any()]
    at = np.ix_(keep, keep)
    M, C, K, G = (
        matrix[at] for matrix in (rotor.M(speed), rotor.C(speed), rotor.K(speed), rotor.G())
    )
    size = len(keep)
    inverse = np.linalg.inv(K)
    # eigenvalues of the inverse: the low ones exact to rounding
    back = np.block(
        [[-inverse @ (C + speed * G), -inverse @ M], [np.eye(size), np.zeros((size, size))]]
    )
    values = 1 / np.linalg.eigvals(back)
    values = values[values.imag > 1e-5 * np.abs(values)]
    values = values[np.argsort(np.abs(values))][:10]
    return np.abs(values), -2 * math.pi * values.real / values.imag


def main():
    """Write machines and numbers."""
    answers = {}
    for file, (build, *unbalances) in MACHINES.items():
        rotor = build()
        path = HERE / FOLDER / file
        path.parent.mkdir(exist_ok=True)
        path.unlink(missing_ok=True)
        rotor.save(path)
        modal = {}
        for speed in SPEEDS[file in NOT_AT_REST :]:
            natural, log_dec = lateral(rotor, speed)
            modal[f"{speed:g}"] = {
                "natural": natural.tolist(),
                "log_dec": log_dec.tolist(),
                "run_modal": np.sort(rotor.run_modal(speed, num_modes=24).wn).tolist(),
            }
        nodes, amounts, phases = (list(item) for item in zip(*unbalances, strict=True))
        response = rotor.run_unbalance_response(
            nodes, amounts, phases, **{"speed_range" if IS_3 else "frequency": np.array(RESPONSES)}
        )
        per_node = rotor.number_dof
        planes = {
            axis: [
                [[z.real, z.imag] for z in response.forced_resp[per_node * node + k]]
                for node in range(max(e.n for e in rotor.shaft_elements) + 2)
            ]
            for k, axis in enumerate("xy")
        }
        answers[file] = {
            "ross_version": rs.__version__,
            "modal": modal,
            "unbalances": unbalances,
            "speeds": RESPONSES,
            **planes,
        }
    (HERE / f"{FOLDER}_answers.json").write_text(json.dumps(answers, indent=1) + "\n")


if __name__ == "__main__":
    main()
