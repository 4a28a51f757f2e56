"""The loop over steps: start at equilibrium, memory, step control, ledger, monitors, outputs."""
