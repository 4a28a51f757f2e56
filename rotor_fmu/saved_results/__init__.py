"""Reading recorded runs and studies for pictures and reports."""
