"""Whirls that a machine feeds by itself, and the step lengths at which an integrator sees them."""
