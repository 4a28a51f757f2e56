"""The loop over steps: memory, step control, energy ledger, watches, what can be read."""
