"""One implicit step of a machine: linear part, interface problem, fitting, excitation."""
