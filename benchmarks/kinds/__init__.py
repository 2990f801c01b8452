"""Families of simulated scans of helical gears, rings and double helical gears, and what is found of their truth."""
