"""Signals as vibration engineers read them: pure functions on arrays, SI inside.

Every function takes the time t [s], the angle of rotation phi [rad] and a displacement
z = x + i y [m] of one place, each of shape (n,), at whatever steps they were recorded:

    from rotor_fmu.vibration import order_track

    track = order_track(t, phi, z)
    track.speed, abs(track.x(1.0)), track.phase_x(1.0)

Amplitudes are 0-p (half of the peak-to-peak value) unless a name says `pp`. Angles are measured
from the keyphasor mark, the shaft's angle 0. Speeds are negative where the angle falls; forward
whirl turns with the shaft, and a lag is negative, whichever way it turns. For many answers about
one signal, resample it once by `synchronous` and take the functions whose names end in `_of`.
"""

from .contact import Contact, contact, power_by_sink
from .orbits import (
    Displacement,
    Orbit,
    Poincare,
    TimeShare,
    Whirl,
    displacement,
    displacement_of,
    orbit,
    poincare,
    time_share,
    whirl,
    whirl_of,
)
from .orders import OrderTrack, Resonance, goes_one_way, order_track, order_track_of, resonances
from .recorded import TooFewRows, TooFewTurns
from .spectra import (
    Cascade,
    FullSpectrum,
    cascade,
    cascade_of,
    full_spectrum,
    full_spectrum_of,
    second_half,
    spectrum,
)
from .turns import TURN, Synchronous, Turns, rows_per_turn, synchronous, turns_of
