"""The loop over steps: equilibrium at the start, memory, step control, energy ledger, monitors,
outputs."""
