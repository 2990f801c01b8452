"""Inspection of any scan, worn or new: ISO 1328-1 deviations and classes, pitch, runout, dimensions, with uncertainty."""

from gearwear.inspection.inspection import Inspection, inspect
from gearwear.inspection.k_band import KBand, KBands
from gearwear.inspection.k_band_file import class_k_bands, read_k_bands
from gearwear.inspection.settings import Settings
from gearwear.inspection.tolerances import FOOTNOTE, Edition, Tolerances, tolerances

__all__ = [
    "FOOTNOTE",
    "Edition",
    "Inspection",
    "KBand",
    "KBands",
    "Settings",
    "Tolerances",
    "class_k_bands",
    "inspect",
    "read_k_bands",
    "tolerances",
]
