"""The scan on the design: registration, the deviation of every point, cells, and the refusal of a scan of another gear."""
