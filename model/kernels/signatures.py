"""The entry points of the kernels: their names, and the numbers that each takes behind its block.

The solver library exports each as `rotor_` and its name; `rotor_fmu/fmi/c/kernels.h` declares them
for C.
"""

REAL, INTEGER = "real", "integer"
# Entry points of a run (`time_loop.entry_points`).
RUN = {
    "start": (REAL, REAL, REAL),
    "advance": (REAL, REAL, REAL),
    "survey": (REAL, INTEGER),
    "refresh_outputs": (),
    "retune": (INTEGER,),
    "differentiate": (INTEGER,),
}
# Entry points of analyses, which no FMU offers: laws along a motion (`step.laws_along_motion`), and
# periodic motions (`periodic.entry_points`).
LAWS = {
    "call_laws": (REAL, REAL, REAL, REAL),
    "linearize_laws": (REAL,),
    "vibrate_laws": (REAL, REAL, REAL),
    "find_gaps": (),
    "find_invalid": (),
}
PERIODIC = {"step_through": (REAL,)}
ANALYSES = LAWS | PERIODIC
