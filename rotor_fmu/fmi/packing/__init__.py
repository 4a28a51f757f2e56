"""Building FMUs: what goes into one, its documents and pages."""
