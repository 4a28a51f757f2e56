"""One implicit step: linear part, interface problem, fitting, excitation."""
