"""Building FMUs: their files, documents and pages."""
