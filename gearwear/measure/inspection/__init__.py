"""Inspection of any scan, worn or new: ISO 1328-1 deviations and classes, pitch, runout, dimensions, with uncertainty."""

from gearwear.measure.inspection.evaluation import KBand
from gearwear.measure.inspection.inspection import Inspection, Settings, inspect
from gearwear.measure.inspection.tolerances import FOOTNOTE, Edition, Tolerances, tolerances

__all__ = ["FOOTNOTE", "Edition", "Inspection", "KBand", "Settings", "Tolerances", "inspect", "tolerances"]
