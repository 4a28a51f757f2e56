"""A machine in matrices: shaft elements, assembly, reduction, equilibrium."""
