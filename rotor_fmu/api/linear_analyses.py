"""The linear analyses of a machine: natural frequencies, responses, statics, checks by API 617."""

import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ..errors import InputError, is_one_of
from ..model.machine.rotor import Rotor
from ..model.simulation import RotorWarning

if TYPE_CHECKING:
    from ..linear.acceptance import CriticalMap, UnbalanceCheck
    from ..linear.answers import Campbell, Modes, Static, UnbalanceResponse
    from ..linear.frequency_answers import FrequencyResponse
    from ..linear.stability_answers import StabilityLevel1, StabilityLevel2

Answer = TypeVar("Answer")

# the analyses are imported when they are called: they need SciPy, which runs do without


@dataclass(frozen=True)
class LinearAnalyses:
    """The linear analyses of a machine; each result shows a table and a picture in a notebook.
    Speeds outside of a part's table over the speed are said by a `RotorWarning`.

    Attributes
    ----------
    rotor : Rotor
        Shaft and parts.
    """

    rotor: Rotor = field(repr=False)

    def modes(self, speed: float | None = None, **options: Any) -> "Modes":
        """Return the natural frequencies, damping and shapes at a speed.

        Parameters
        ----------
        speed : float, optional
            Speed of rotation [rad/s]. By default 0, and the rated speed of a machine that oil films
            hold.
        count : int
            Number of modes, the lowest ones.
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.

        Returns
        -------
        Modes
            Eigenvalues [1/s] and shapes, with a table and a picture.

        Raises
        ------
        LinearError
            If the speed is not finite, or `contacts` is another word.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> found = rf.load().modes(contacts="pinned")
        >>> [f"{omega:.0f} rad/s" for omega in found.natural[:2]]
        ['186 rad/s', '204 rad/s']
        """
        from ..linear.answers import modes

        result = modes(self.rotor, speed, **options)
        return _said(result, self.rotor, [result.speed])

    def campbell(self, speeds: Sequence[float] | np.ndarray, **options: Any) -> "Campbell":
        """Return the frequencies over speeds, critical speeds and the threshold of stability.

        Parameters
        ----------
        speeds : sequence of float
            At least two ascending speeds of rotation [rad/s].
        count : int
            Number of modes, the lowest ones.
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.
        harmonic : float or sequence of float
            Multiples of the speed that excite, for critical speeds [1].

        Returns
        -------
        Campbell
            Eigenvalues [1/s], critical speeds and threshold [rad/s], with a table and a picture.

        Raises
        ------
        LinearError
            If the speeds do not ascend, or `contacts` is another word.
        """
        from ..linear.answers import campbell

        return _said(campbell(self.rotor, speeds, **options), self.rotor, speeds)

    def unbalance_response(
        self, speeds: Sequence[float] | np.ndarray, **options: Any
    ) -> "UnbalanceResponse":
        """Steady response to unbalances over speeds.

        Parameters
        ----------
        speeds : sequence of float
            Speeds of rotation [rad/s].
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.
        unbalances : sequence of (int, float, float), optional
            Node (from 1), amount [kg.m] and angle from the shaft's mark [rad] of each unbalance. By
            default the machine's own, with its bows.

        Returns
        -------
        UnbalanceResponse
            Complex amplitudes [m] and loads on the supports [N], with a table and a picture.

        Raises
        ------
        LinearError
            If a speed or a node cannot be, or `contacts` is another word.
        """
        from ..linear.answers import unbalance_response

        return _said(unbalance_response(self.rotor, speeds, **options), self.rotor, speeds)

    def unbalance_check(
        self, low: float, high: float, probes: Sequence[int], **options: Any
    ) -> "UnbalanceCheck":
        """Response to unbalance held against API 617 and 684 in an operating range.

        Parameters
        ----------
        low, high : float
            Minimum and maximum continuous speed [rad/s].
        probes : sequence of int
            Nodes (from 1) with probes.
        unbalances : sequence of (int, float, float), optional
            Node (from 1), amount [kg.m] and angle [rad] of each unbalance. By default the machine's
            own, with its bows.
        clearances : mapping of int to float, optional
            Radial clearances [m] of seals by their nodes (from 1).
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.

        Returns
        -------
        UnbalanceCheck
            Critical speeds with amplification factors and separation margins, levels at the probes,
            clearances, with a table and a picture.

        Raises
        ------
        LinearError
            If the range, a node or a clearance cannot be.
        """
        from ..linear.acceptance import unbalance_check
        from ..model.linear.unbalance_check import highest_of_interest

        result = unbalance_check(self.rotor, low, high, probes, **options)
        return _said(result, self.rotor, [low, highest_of_interest(self.rotor, high)])

    def critical_map(
        self, stiffness: Sequence[float] | np.ndarray | None = None, **options: Any
    ) -> "CriticalMap":
        """Undamped critical speeds over the stiffness of the bearings.

        Parameters
        ----------
        stiffness : sequence of float, optional
            Ascending stiffnesses of every bearing [N/m]. By default two decades on either side of
            the bearings' own.
        count : int
            How many critical speeds, the lowest at each stiffness, lie on lines.
        synchronous : bool
            False for natural frequencies at standstill instead of forward critical speeds.
        rigid_pedestals : bool
            Whether housings are taken as ground.
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.

        Returns
        -------
        CriticalMap
            The lines and the bearings' own stiffness, with a table and a picture.

        Raises
        ------
        LinearError
            If the stiffnesses do not ascend from above 0, or the machine has no bearing.
        """
        from ..linear.acceptance import critical_map
        from ..model.linear.undamped import without_seals

        result = critical_map(self.rotor, stiffness, **options)
        return _said(result, without_seals(self.rotor), [each.speed for each in result.crossings])

    def stability(
        self, speed: float, level: int = 1, **options: Any
    ) -> "StabilityLevel1 | StabilityLevel2":
        """Stability of the forward modes by API 617 and 684.

        Parameters
        ----------
        speed : float
            Maximum continuous speed [rad/s], above 0.
        level : int
            1 for the logarithmic decrement over the cross coupling, 2 for what each seal does.
        node : int, optional
            With level 1, node (from 1) of the cross coupling. By default midway between the
            bearings, or at the largest stage where all stand beyond them.
        anticipated : float or mapping of int to float
            With level 1, the cross coupling that is expected, QA [N/m], or each stage's by its
            node.
        cross_couplings : mapping of int to float, optional
            With level 2, cross coupling [N/m] by node (from 1).
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.

        Returns
        -------
        StabilityLevel1 or StabilityLevel2
            Logarithmic decrements and thresholds, with a table and a picture.

        Raises
        ------
        LinearError
            If the speed or a node cannot be.
        InputError
            If the level is neither 1 nor 2.
        """
        from ..linear.stability_answers import level_1, level_2
        from ..model.linear.undamped import without_seals

        if not is_one_of(level, (1, 2)):
            raise InputError(f"level = {level!r}: must be 1 or 2")
        if level == 1:
            bare = self.rotor if options.get("seals") else without_seals(self.rotor)
            return _said(level_1(self.rotor, speed, **options), bare, [speed])
        return _said(level_2(self.rotor, speed, **options), self.rotor, [speed])

    def frequency_response(
        self,
        frequencies: Sequence[float] | np.ndarray,
        force: int | tuple[int, float] | str,
        nodes: Sequence[int | tuple[int, float]],
        **options: Any,
    ) -> "FrequencyResponse":
        """Displacements of nodes by a force on a node, or by the base's acceleration, over the
        frequency.

        Parameters
        ----------
        frequencies : sequence of float
            Frequencies of the force [rad/s], above 0.
        force : int or (int, float) or str
            Node (from 1) of the force, or such a node with how far beyond it the force acts [m], or
            `base`: the base is accelerated, and displacements are relative to it.
        nodes : sequence of int or (int, float)
            Nodes (from 1), or places beyond them, whose displacement is asked for.
        speed : float
            Speed of rotation [rad/s].
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.

        Returns
        -------
        FrequencyResponse
            Complex receptances [m/N], of the base [m/(m/s2)], with a table and a picture.

        Raises
        ------
        LinearError
            If a frequency or a node cannot be.
        """
        from ..linear.frequency_answers import frequency_response

        result = frequency_response(self.rotor, frequencies, force, nodes, **options)
        return _said(result, self.rotor, [result.speed])

    def static(self, speed: float | None = None, **options: Any) -> "Static":
        """Deflection and loads on the supports under gravity and loads.

        Parameters
        ----------
        speed : float, optional
            Speed of rotation [rad/s], on which bearings may depend. By default 0, and the rated
            speed of a machine that oil films hold.
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.
        loads : sequence of (int, float, float)
            Node (from 1), force to the right and force upwards [N] of each further load.

        Returns
        -------
        Static
            Displacements [m], slopes [rad] and loads [N], with a table and a picture.

        Raises
        ------
        LinearError
            If nothing holds the machine, or a node cannot be, or `contacts` is another word.
        """
        from ..linear.answers import static

        result = static(self.rotor, speed, **options)
        return _said(result, self.rotor, [result.speed])


def _said(result: Answer, rotor: Rotor, speeds: Iterable[float]) -> Answer:
    """Return an answer, after a `RotorWarning` for each range of a machine, of a table or of a
    laminar film, that ends before some of these speeds [rad/s]."""
    from ..linear.where_linearized import where_beyond_ranges

    for sentence in where_beyond_ranges(rotor, [*speeds]):
        warnings.warn(RotorWarning(sentence), stacklevel=3)
    return result
