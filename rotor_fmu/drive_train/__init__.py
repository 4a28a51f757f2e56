"""`rotor-fmu drive-train`: a motor, its FMU, and both FMUs coupled."""
