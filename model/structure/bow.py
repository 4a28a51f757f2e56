"""The bow of a shaft that is hot on one side at a node, or not straight there.

An element that is hot on one side would bend evenly, free of force (Bachschmid, Pennacchi and Vania
2007: a pair of moments at its ends). Here the two elements beside the node do so, with the same
curvature, and the rest of the shaft stays straight. The bow is the displacement of the node from
the straight line through the ends of the shaft.
"""

import numpy as np

from ..kernels.band import product
from ..machine.rotor import Rotor
from ..parts.base import BowElement, Element, InterfaceElement
from .structure import BOW


def bow_shape(nodes: np.ndarray, node: int) -> np.ndarray:
    """Return deflection and slope at each node for a bow of 1 at a node between the ends.

    nodes: positions [m]; node: from 1.
    """
    lengths = np.diff(nodes)
    bend = np.zeros(len(nodes))
    bend[node - 1] = -lengths[node - 2]
    bend[node:] = -lengths[node - 2] - lengths[node - 1]
    deflection = np.append(0.0, np.cumsum(0.5 * lengths * (bend[1:] + bend[:-1])))
    chord = deflection[-1] / (nodes[-1] - nodes[0])
    deflection -= chord * (nodes - nodes[0])
    return np.column_stack([deflection, bend - chord]).ravel() / deflection[node - 1]


def bows_of(
    rotor: Rotor, elements: list[Element], K_shaft: np.ndarray
) -> tuple[np.recarray, np.ndarray, np.ndarray]:
    """Return `bows`, `bow_forces` and `bow_stiffness` of a `Structure`; K_shaft: a band matrix."""
    residual = [e for e in elements if isinstance(e, BowElement)]
    records = [(-1, bow.amplitude, bow.phase) for bow in residual]
    nodes, state = [bow.node for bow in residual], 0
    for element in elements:
        if isinstance(element, InterfaceElement):
            if element.law.bow is not None:
                records.append((state + element.law.bow, 0.0, 0.0))
                nodes.append(element.node)
            state += len(element.law.states_of(element.source))
    shape = np.array([bow_shape(np.array(rotor.nodes), node) for node in nodes])
    shape = shape.reshape(-1, len(K_shaft))
    forces = np.array([product(K_shaft, s) for s in shape]).reshape(shape.shape)
    return np.array(records, dtype=BOW).view(np.recarray), forces, shape @ forces.T
