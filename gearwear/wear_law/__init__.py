"""Archard's law on the worn flanks: its fit, what it explains, and the forecast from it."""
