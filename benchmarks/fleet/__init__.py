"""A fleet of simulated scans with known truth, through batch, trend and gauge."""
