"""gearwear: from the scan of a worn spur gear to the metal that is gone, what it does to the meshing, and what caused the rest."""

__version__ = "0.1.0"
