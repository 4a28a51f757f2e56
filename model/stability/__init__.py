"""Self-excited whirls of a machine, and the step lengths at which an integrator resolves them."""
