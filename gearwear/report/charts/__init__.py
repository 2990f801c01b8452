"""Inspection charts as a gear measuring machine prints them: profile, helix, pitch with runout, flank topography.

Charts are laid out in millimetres of paper, so that a stated magnification is true at the printed size (A4 landscape, longer where
many teeth are drawn on one sheet). Each function draws on the figure it is given, sets its size, and returns it.
"""

from gearwear.report.charts.areal import areal_chart
from gearwear.report.charts.kinds import charts_of
from gearwear.report.charts.pitch import pitch_chart
from gearwear.report.charts.topography import topography_chart
from gearwear.report.charts.traces import helix_chart, profile_chart

__all__ = [
    "areal_chart",
    "charts_of",
    "helix_chart",
    "pitch_chart",
    "profile_chart",
    "topography_chart",
]
