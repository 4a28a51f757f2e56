"""What is looked at after every step: the probes' amplitudes, and the false wall-to-wall state."""

from __future__ import annotations

import math

from ..kernels.compiled import compiled
from ..kernels.functions import modulus
from ..step.laws import relative

# A journal that crosses its whole clearance in at most CROSSING_STEPS steps again and again is in
# the integrator's limit cycle, not in the machine's motion: a crossing scores CROSSING_SCORE, any
# step takes one away, and at TRAPPED_SCORE (some twenty crossings) the state is called false.
CROSSING_STEPS = 2
CROSSING_SCORE = 3.0
TRAPPED_SCORE = 60.0


@compiled
def watch_amplitudes(structure, motion, memory):
    """Largest displacements of the probes, over the last whole revolution and what has passed of
    the present one."""
    r = memory.record[0]
    peaks = memory.peaks
    if abs(r.theta - r.turn) >= 2.0 * math.pi:
        r.turn = r.theta
        for axis in range(2):
            for i in range(len(structure.probes)):
                peaks[1, axis, i] = peaks[0, axis, i]
                peaks[0, axis, i] = 0.0
    for i in range(len(structure.probes)):
        q = motion.q[structure.probes[i].dof]
        x = abs(q.real)
        y = abs(q.imag - memory.rest[i])
        for window in (0, 2):
            peaks[window, 0, i] = max(peaks[window, 0, i], x)
            peaks[window, 1, i] = max(peaks[window, 1, i], y)


@compiled
def watch_bounces(structure, motion, memory):
    """Count the steps in which a journal keeps hitting opposite walls within a step or two."""
    r = memory.record[0]
    interfaces = structure.interfaces
    bounce = memory.bounce
    for j in range(len(interfaces)):
        if interfaces[j].has_wall == 0:
            continue
        bounce[j, 2] += 1.0
        bounce[j, 3] = max(0.0, bounce[j, 3] - 1.0)
        if motion.force[j] != 0.0:
            d = relative(interfaces[j], motion.q)
            e = d / modulus(d)
            is_opposite = e.real * bounce[j, 0] + e.imag * bounce[j, 1] < -0.5
            if is_opposite and bounce[j, 2] <= CROSSING_STEPS:
                bounce[j, 3] = min(2.0 * TRAPPED_SCORE, bounce[j, 3] + CROSSING_SCORE)
            bounce[j, 0] = e.real
            bounce[j, 1] = e.imag
            bounce[j, 2] = 0.0
        if bounce[j, 3] >= TRAPPED_SCORE:
            r.trapped += 1
            if math.isnan(r.trapped_at):
                r.trapped_at = r.t
