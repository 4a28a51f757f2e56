"""What a step costs over the length of the shaft: python -m benchmarks.long_shafts

CPU time of a step of 0.1 ms of machines with 15 to 240 elements, two bearings given by tables and
two touchdown bearings in which they lie and slide, the speed changing with every step; least of
several stretches.
"""

import time

from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

ELEMENTS = (15, 30, 60, 120, 240)
STEP, STEPS, REPETITIONS = 1e-4, 2000, 9
SPEED, RATE = 300.0, -10.0  # rad/s, rad/s2


def machine(elements: int) -> Rotor:
    """A shaft of 1.2 m that sags through its clearances on soft bearings."""
    table = """
kxx = [1e5, 1.5e5, 2e5]
kyy = [1e5, 1.2e5, 2e5]
kxy = [1e3, 2e3, 3e3]
cxx = [300.0, 200.0, 100.0]
cyy = [300.0, 200.0, 100.0]
speed = [0.0, 200.0, 400.0]
"""
    text = f"""
[material]
young = 2.1e11
density = 7800.0
[[section]]
length = 1.2
outer = 0.06
elements = {elements}
[[unbalance]]
node = {elements // 2 + 1}
amount = 1e-4
"""
    for at in (1, elements + 1):
        text += f"[[linear_bearing]]\nnode = {at}\n{table}"
    for at in (elements // 5 + 1, elements - elements // 5 + 1):
        text += f"""
[[touchdown_bearing]]
node = {at}
journal_radius = 0.03
clearance = 1e-4
mu = 0.1
k = 1e8
race_inertia = 1e-4
race_drag = 0.05
"""
    return parse_rotor(text)


def cost(elements: int) -> tuple[float, float]:
    """CPU time of a step [s], and the share of samples in contact [1]."""
    sim = Simulation(machine(elements), choose("robust", h=STEP), speed=SPEED, rate=RATE)
    best, contacts = float("inf"), 0.0
    for _ in range(REPETITIONS + 1):  # the first is not counted: caches
        begun = time.process_time()
        sim.advance(sim.time + STEPS * STEP, SPEED + RATE * sim.time)
        best = min(best, (time.process_time() - begun) / STEPS)
        contacts += sim.read("touchdown_bearing[1].contact") / (REPETITIONS + 1)
    return best, contacts


def main() -> None:
    """Print the table."""
    print("elements    us a step    us a step and element    in contact")
    for elements in ELEMENTS:
        seconds, contacts = cost(elements)
        each = 1e6 * seconds / elements
        print(f"{elements:8d} {1e6 * seconds:12.2f} {each:24.3f} {contacts:13.0%}")


if __name__ == "__main__":
    main()
