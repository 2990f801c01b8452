"""The proof of the closed loop: scans made by a generator that shares no code with the fit, which is told nothing."""
