"""Bearings and dampers alone, over speed or load: where they rest, their coefficients, and what
happens in them."""

from .damper import DamperCurves, damper_curves
from .floating_ring import RingCurves, ring_curves
from .journal_bearing import BearingCurves, bearing_curves, bearings
from .rolling_bearing import RollingCurves, rolling_curves
