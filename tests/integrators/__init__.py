"""Time integration: schemes, their error control, sensitivities."""
