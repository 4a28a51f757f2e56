"""The false state of integrators under contact: its cycles, one direction of bouncing, impacts."""
