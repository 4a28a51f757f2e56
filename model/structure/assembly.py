"""`Rotor` -> `Structure`: band matrices, and the records of everything that acts on them.

The rotor's equation in complex coordinates q (deflection and slope at each node, x + i y):

    M q'' + (C - i Omega G) q' + (K - i kappa K_s - i/2 Omega' G) q = f(t) + B F

with F the interfaces' forces on the nodes. The housings are separate oscillators, m z'' + c z' + k
z = f - F, with different springs and dampers in x and y. -i/2 Omega' G is the transient stiffness
of the gyroscopic terms, without which the energy balance of a rotor with changing speed is not
closed.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..kernels.band import factorize, product
from ..kernels.kernel import interpreted
from ..machine.rotor import Rotor
from ..parts import LAWS
from ..parts.base import (
    BASE,
    GROUND,
    AddedMassElement,
    BodyElement,
    Element,
    ForceElement,
    InterfaceElement,
    MountElement,
    PortElement,
    ProbeElement,
    ReleaseElement,
    SpringElement,
    UnbalanceElement,
    VelocityElement,
    outputs_of,
)
from ..parts.housing import HousingQuantities
from ..parts.law_probe import numbers_of
from .beam import shaft_element
from .bow import bows_of
from .ledger import law_entries
from .lowest_frequency import lowest_omega
from .parameters import prepare
from .structure import (
    FORCE,
    HOUSING,
    INTERFACE,
    LOAD,
    NUMBERS,
    PROBE,
    RELEASE,
    SPRING,
    UNBALANCE,
    WEIGHT,
    Structure,
)

HALF_BANDWIDTH = 3


def assemble(rotor: Rotor) -> Structure:
    """Return the matrices and records of a machine (Nelson 1980; Zorzi and Nelson 1977)."""
    n = 2 * len(rotor.nodes)
    elements = list(machine_elements(rotor))
    M, M_shaft, G, K_shaft, K_axial, inertia = _matrices(rotor, elements)
    mass_sum = product(M, np.arange(n) % 2 == 0)
    one_body = _one_body(rotor, M)
    for _, added in _of_kind(AddedMassElement, elements):
        M[_dof(added), 0] += added.mass
    springs = _rows(
        SPRING, [(_dof(s), s.stiffness, s.damping) for _, s in _of_kind(SpringElement, elements)]
    )
    M_factors = M.copy()
    interpreted(factorize)(M_factors)
    # of each element's first output among those of all parts
    outputs = [0, *np.cumsum([len(outputs_of(element)) for element in elements]).tolist()]
    housings, interfaces, laws = _mechanism(n, elements, outputs)
    bows, bow_forces, bow_stiffness = bows_of(rotor, elements, K_shaft)
    stores, losses = law_entries(rotor)
    placed_ports = _of_kind(PortElement, elements)
    ports = [port for _, port in placed_ports]
    held = soft_stiffness(len(M), springs, elements)
    numbers = _numbers(rotor, ports)
    numbers[0].own_inertia = inertia
    numbers[0].is_supported = np.count_nonzero(held) >= 2
    firm = [
        i
        for _, i in _of_kind(InterfaceElement, elements)
        if i.ring == GROUND and i.law.stiffness is None
    ]
    bearings, walls = ([_dof(i) for i in firm if i.law.has_wall == w] for w in (False, True))
    numbers[0].lowest_omega = lowest_omega(rotor, M, K_shaft, K_axial, held, bearings, walls)
    unbalances = [u for _, u in _of_kind(UnbalanceElement, elements)]
    structure = Structure(
        M=M,
        C=np.zeros((n, HALF_BANDWIDTH + 1)),
        K=np.zeros((n, HALF_BANDWIDTH + 1)),
        G=G,
        M_shaft=M_shaft,
        K_shaft=K_shaft,
        K_axial=K_axial,
        M_factors=M_factors,
        weights=_weights(M),
        mass_sum=mass_sum,
        static_load=np.zeros(n, dtype=complex),
        releases=_rows(
            RELEASE, [tuple(element) for _, element in _of_kind(ReleaseElement, elements)]
        ),
        one_body=one_body,
        deflections=np.array([(2 * i, i + 1) for i in range(n // 2)], dtype=np.int64),
        load_dof=np.array([-1 if p.node == BASE else _dof(p) for p in ports], dtype=np.int64),
        load_arms=_rows(
            LOAD, [(_slope(p), outputs[i], p.offset, p.impedance) for i, p in placed_ports]
        ),
        probes=_rows(
            PROBE,
            [
                (_dof(p), _slope(p), outputs[i], p.offset)
                for i, p in _of_kind(ProbeElement, elements)
            ],
        ),
        velocities=_rows(
            PROBE,
            [(_dof(v), _dof(v), outputs[i], 0.0) for i, v in _of_kind(VelocityElement, elements)],
        ),
        unbalances=_rows(UNBALANCE, [(_dof(u), _slope(u), *u[1:]) for u in unbalances]),
        unbalance=np.zeros(len(unbalances), dtype=complex),
        forces=_rows(
            FORCE,
            [(_dof(f), _slope(f), *f[1:]) for _, f in _of_kind(ForceElement, elements)],
        ),
        springs=springs,
        bows=bows,
        bow=np.zeros(len(bows), dtype=complex),
        bow_forces=bow_forces,
        bow_stiffness=bow_stiffness,
        housings=housings,
        interfaces=interfaces,
        laws=laws,
        stores=np.array(stores, dtype=np.int64),
        losses=np.array(losses, dtype=np.int64),
        numbers=numbers,
    )
    interpreted(prepare)(structure)
    return structure


def _matrices(
    rotor: Rotor, elements: list[Element]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, float]:
    """Return the mass of the shaft with its bodies and without, their gyroscopic matrix, the
    shaft's stiffness, that by its axial force, and the polar inertia [kg.m2]."""
    M, G, K_shaft, K_axial = (
        np.zeros((2 * len(rotor.nodes), HALF_BANDWIDTH + 1)) for _ in range(4)
    )
    inertia = 0.0
    for i, section in enumerate(rotor.sections):
        element = shaft_element(section)
        _add(M, 2 * i, element.translation + element.tilting)
        _add(G, 2 * i, 2 * element.tilting)
        _add(K_shaft, 2 * i, element.stiffness)
        _add(K_axial, 2 * i, element.tension)
        inertia += sum(layer.polar_inertia for layer in section.all_layers)
    M_shaft = M.copy()
    for _, body in _of_kind(BodyElement, elements):
        dof = _dof(body)
        M[dof, 0] += body.mass
        M[dof, 1] += body.mass * body.offset
        M[dof + 1, 0] += body.diametral + body.mass * body.offset**2
        G[dof + 1, 0] += body.polar
        inertia += body.polar
    return M, M_shaft, G, K_shaft, K_axial, inertia


def _numbers(rotor: Rotor, ports: list[PortElement]) -> np.recarray:
    """Return the record of the machine's numbers, with those that need no matrices."""
    numbers = np.zeros(1, NUMBERS).view(np.recarray)
    numbers[0].rotating_damping = rotor.rotating_damping
    numbers[0].eta_v, numbers[0].eta_h = rotor.eta_v, rotor.eta_h
    numbers[0].mass_damping = rotor.mass_damping
    numbers[0].gravity = rotor.gravity
    numbers[0].down_x, numbers[0].down_y = rotor.down.real, rotor.down.imag
    moved_bases = [i for i, port in enumerate(ports) if port.node == BASE]
    numbers[0].base_load = moved_bases[0] if moved_bases else -1
    numbers[0].bound, numbers[0].small = 0.1 * rotor.length, 1e-4 * rotor.length
    return numbers


def machine_elements(rotor: Rotor) -> list[Element]:
    """Return the elements of all parts, in the order of the parts."""
    return [element for _, element in rotor.indexed_elements()]


def interface_names(rotor: Rotor) -> list[str]:
    """Return the names of the parts that the interfaces belong to, in the interfaces' order."""
    return [where for where, _ in rotor.elements_of_kind(InterfaceElement)]


def _of_kind(kind: type, elements: list[Element]) -> list[tuple[int, Any]]:
    """Return the elements of a kind, with their indices among all."""
    return [(i, element) for i, element in enumerate(elements) if isinstance(element, kind)]


def _dof(element: Any) -> int:
    """Return the deflection at which an element acts."""
    return 2 * (element.node - 1)


def _slope(element: Any) -> int:
    """Return the slope there if the element has an offset, otherwise the deflection again."""
    return _dof(element) + (element.offset != 0)


def _rows(dtype: np.dtype, rows: list[tuple]) -> np.recarray:
    return np.array(rows, dtype=dtype).view(np.recarray)


def _mechanism(
    n: int, elements: list[Element], outputs: list[int]
) -> tuple[np.recarray, np.recarray, tuple[np.ndarray, ...]]:
    """Return housings, interfaces, the records of each law and the tables; n: the shaft's dofs."""
    mounts = _of_kind(MountElement, elements)
    places = {mount.name: n + h for h, (_, mount) in enumerate(mounts)} | {GROUND: n + len(mounts)}
    housings = [(outputs[i], *numbers_of(HousingQuantities, m.source)) for i, m in mounts]
    rows: list[list[tuple]] = [[] for _ in LAWS]
    interfaces = []
    tables: list[float] = []
    internal_state = first_vibrating = 0
    for i, element in _of_kind(InterfaceElement, elements):
        code = LAWS.index(element.law)
        states = len(element.law.states_of(element.source))
        vibrating = states if element.law.vibrates else 0
        interfaces.append(
            (
                code,
                len(rows[code]),
                places[element.ring] if element.ring != GROUND else _dof(element),
                places[element.housing],
                internal_state,
                states,
                first_vibrating,
                vibrating,
                outputs[i],
                element.law.has_wall,
                element.law.has_wall and not element.law.turns,
                outputs[i] + len(element.law.outputs_of(element.source)),
                0.0,
            )
        )
        record = numbers_of(element.law.kind, element.source)
        if element.law.table is not None:
            table = element.law.table(element.source)
            record = (*record, len(tables), len(table))
            tables += table.ravel().tolist()
        rows[code].append(record)
        internal_state += states
        first_vibrating += vibrating
    laws = tuple(_rows(law.dtype, of) for law, of in zip(LAWS, rows, strict=True))
    return _rows(HOUSING, housings), _rows(INTERFACE, interfaces), (*laws, np.array(tables))


def _add(band: np.ndarray, first: int, matrix: np.ndarray) -> None:
    """Add a symmetric matrix to a band matrix, from this row and column on."""
    for column in range(len(matrix)):
        band[first + column, : len(matrix) - column] += matrix[column:, column]


def _one_body(rotor: Rotor, M: np.ndarray) -> np.ndarray:
    """Return displacement and tilt of the shaft as one body about its centre of mass, shape (2,
    n)."""
    along, tilt = np.zeros(len(M)), np.ones(len(M))
    along[::2] = 1.0
    tilt[::2] = np.array(rotor.nodes) - rotor.nodes[0]
    pull = product(M, along)
    tilt -= (pull @ tilt) / (pull @ along) * along
    return np.array([along, tilt])


def _weights(M: np.ndarray) -> np.recarray:
    lumped = np.zeros(len(M))
    lumped[::2] = M[::2, 0] + M[::2, 2]
    lumped[2::2] += M[:-2:2, 2]
    lumped /= lumped.sum()
    return _rows(WEIGHT, [(i, i, lumped[i]) for i in np.flatnonzero(lumped)])


def soft_stiffness(n: int, springs: np.recarray, elements: list[Element]) -> np.ndarray:
    """Return the stiffness of springs and soft laws at each dof [N/m], shape (n,)."""
    stiffness = np.zeros(n)
    np.add.at(stiffness, springs.dof, springs.stiffness)
    for _, i in _of_kind(InterfaceElement, elements):
        if i.law.stiffness is not None and i.ring == GROUND:
            stiffness[_dof(i)] += max(0.0, i.law.stiffness(i.source))
    return stiffness


def with_renumbered_dofs(
    structure: Structure, place: Callable[[np.ndarray], np.ndarray]
) -> dict[str, Any]:
    """Return the members of a structure that name dofs, with each dof replaced by its new
    number."""
    load_dof = structure.load_dof.copy()
    load_dof[load_dof >= 0] = place(load_dof[load_dof >= 0])
    load_arms = structure.load_arms.copy()
    load_arms.slope[load_dof >= 0] = place(load_arms.slope[load_dof >= 0])
    changed: dict[str, Any] = {"load_dof": load_dof, "load_arms": load_arms}
    for name in ("probes", "velocities", "unbalances", "forces", "springs", "interfaces"):
        records = getattr(structure, name).copy()
        records.dof = place(records.dof)
        if "slope" in records.dtype.names:
            records.slope = place(records.slope)
        changed[name] = records
    return changed
