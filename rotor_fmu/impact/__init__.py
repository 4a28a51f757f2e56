"""`rotor-fmu impact`: paper B's experiments and their pictures."""
