"""A law with states of its own, called with states that are given, and differences of it."""

import numpy as np
from rotor_fmu.model.backend import bound_unless_compiled
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.parts import LAWS
from rotor_fmu.model.step.laws_along_motion import block_of, call_laws, single_law


class StatedLaw:
    """The functions of a law that stands alone (`model.parts.law_probe`)."""

    def __init__(self, alone):
        self.alone, self.law, self.speed = alone, alone._law, alone.speed
        self.count = len(alone._states)
        one = single_law(self.law, alone._record, alone._tables, self.count)
        block, data = block_of(*one, samples=1)
        # where the law that is called puts its pads
        laws = data.machine.laws
        self.record, self.tables = laws[LAWS.index(self.law)][0], laws[-1]
        self._sample, self._call_laws = data.samples, bound_unless_compiled(call_laws, block)

    def _called(self, function, d, v, *more):
        moving = self.alone._moving(d, v)
        return interpreted(function)(self.record, self.tables, moving, *more)

    def _at(self, d, v, weights, own):
        at = self._sample
        at.d[0, 0], at.v[0, 0] = d, v
        at.states[0] = at.solved[0] = own
        self._call_laws(*map(float, weights), self.speed)
        return at

    def step(self, d, v, weights, free):
        """Force, tangent and states at the end of a step."""
        at = self._at(d, v, weights, free)
        p, q = at.p[0, 0, 0], at.q[0, 0, 0]
        tangent = np.array([[(p + q).real, (q - p).imag], [(p + q).imag, (p - q).real]])
        return complex(at.force[0, 0]), tangent, at.solved[0].copy()

    def force(self, d, v, own):
        return self._called(self.law.force, d, v, own)

    def rates(self, d, v, own):
        return self._at(d, v, (1.0, 0.0, 0.0), own).rates[0].copy()

    def has_tangent(self, d, v, weights, free, length, share):
        """Whether a step's tangent is that of differences of its force, of one of three lengths of
        these, within a share of its largest entry."""
        _, tangent, _ = self.step(d, v, weights, free)
        for h in (1e-4, 1e-3, 1e-5):
            h *= length * self.speed / weights.velocity
            columns = []
            for z in (1.0, 1j):
                by_d, by_v = h * weights.displacement * z, h * weights.velocity * z
                ahead, behind = (
                    self.step(d + s * by_d, v + s * by_v, weights, free)[0] for s in (1, -1)
                )
                change = (ahead - behind) / (2 * h)
                columns.append([change.real, change.imag])
            if np.abs(np.transpose(columns) - tangent).max() < share * np.abs(tangent).max():
                return True
        return False

    def vibration(self, d, rest, w, size, scales):
        """By how much the force answers a vibration of small size with the frequency w [rad/s]
        about a displacement, where the states rest; they follow by their own rates, linearized by
        differences of these scales. Complex, shape (2, 2)."""
        columns = []
        for i, scale in enumerate([size, size, size * self.speed, size * self.speed, *scales]):
            ends = []
            for s in (1.0, -1.0):
                moved, own = [d, 0j], rest.copy()
                if i < 4:
                    moved[i // 2] += s * scale * (1.0, 1j)[i % 2]
                else:
                    own[i - 4] += s * scale
                force = self.force(*moved, own)
                ends.append([force.real, force.imag, *self.rates(*moved, own)])
            columns.append((np.array(ends[0]) - ends[1]) / (2 * scale))
        both = np.array(columns).T
        F, r = both[:2], both[2:]
        left = 1j * w * np.eye(self.count) - r[:, 4:]
        states = np.linalg.solve(left, r[:, :2] + 1j * w * r[:, 2:4])
        return F[:, :2] + 1j * w * F[:, 2:4] + F[:, 4:] @ states
