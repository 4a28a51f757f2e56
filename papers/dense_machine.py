"""A machine in dense matrices, its clearance contacts and its static equilibrium."""

import numpy as np
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.parts import LAWS
from rotor_fmu.model.parts.clearance_contact import CLEARANCE_CONTACT
from rotor_fmu.model.parts.housing import masses
from rotor_fmu.model.quantities import quantities
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.structure import Structure

X, Y = 0, 1
# `dof`: of the node; `end`: of its housing behind the dofs, or of ground, the last.
CONTACT = np.dtype([("dof", "i8"), ("end", "i8"), *CLEARANCE_CONTACT.dtype.descr])


def clearance_contacts(structure: Structure) -> np.recarray:
    """Return a copy of the clearance contacts, in their order, dtype `CONTACT`, shape (m,)."""
    code = LAWS.index(CLEARANCE_CONTACT)
    interfaces = structure.interfaces[structure.interfaces.law == code]
    contacts = np.zeros(len(interfaces), CONTACT).view(np.recarray)
    contacts.dof, contacts.end = interfaces.dof, interfaces.end
    for name in quantities(CLEARANCE_CONTACT.kind):
        contacts[name] = structure.laws[code][name][interfaces.row]
    return contacts


def contact_picks(structure: Structure) -> np.ndarray:
    """Return the rows that pick each clearance contact's node less its housing, in one plane, shape
    (contacts, n + housings)."""
    contacts = clearance_contacts(structure)
    rows = np.arange(len(contacts))
    picks = np.zeros((len(contacts), len(structure.static_load) + len(structure.housings) + 1))
    picks[rows, contacts.dof] = 1.0
    picks[rows, contacts.end] = -1.0
    return picks[:, :-1]  # ground does not move


def in_plane(structure: Structure, axis: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return M, C, K along `X` or `Y`, the housings behind the dofs, shape (n + housings, n +
    housings)."""
    housings = structure.housings
    m_x, m_y = interpreted(masses)(housings)
    own = ((m_x, housings.cx, housings.kx), (m_y, housings.cy, housings.ky))[axis]
    n = len(structure.static_load)
    result = []
    for band, diagonal in zip((structure.M, structure.C, structure.K), own, strict=True):
        matrix = np.zeros((n + len(housings), n + len(housings)))
        matrix[:n, :n] = to_dense(band)
        matrix[range(n, len(matrix)), range(n, len(matrix))] = diagonal
        result.append(matrix)
    return result[0], result[1], result[2]


def rest(rotor: Rotor) -> np.ndarray:
    """Return the static displacements under the weight, without spin and friction, complex, shape
    (n + housings + 1,) as in `Motion` [m]. Raises `EquilibriumError`."""
    return Simulation(rotor).motion.q.copy()
