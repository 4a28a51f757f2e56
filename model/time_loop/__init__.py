"""The loop over steps: memory, step control, energy ledger, monitors, what can be read."""
