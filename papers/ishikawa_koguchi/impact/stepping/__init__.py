"""Steps of a linear structure with hard or compliant contacts."""
