"""The FMU in Python, and what both kinds of FMU share: rules of FMI, hosts, couplings."""
