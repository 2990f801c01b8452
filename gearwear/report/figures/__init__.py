"""Figures: each function draws one on axes that it is given; `gearwear.figures`."""

from gearwear.report.figures.loaded import load_map, loaded_transmission_error, mesh_spectrum
from gearwear.report.figures.maps import (
    STYLE,
    backlash,
    colour_bar,
    colours,
    contact_map,
    flank_map,
    magnification,
    outline,
    teeth_in_a_row,
    thickness_per_tooth,
    thinned,
    tooth_section,
    traces,
    transmission_error,
    waterfall,
)
from gearwear.report.figures.meshing import pair_in_mesh, sliding_velocity, specific_sliding
from gearwear.report.figures.running import wear_maps
from gearwear.report.figures.wear_law import across_face, greatest_depth, worn_profile

__all__ = [
    "STYLE",
    "across_face",
    "backlash",
    "colour_bar",
    "colours",
    "contact_map",
    "flank_map",
    "greatest_depth",
    "load_map",
    "loaded_transmission_error",
    "magnification",
    "mesh_spectrum",
    "outline",
    "pair_in_mesh",
    "sliding_velocity",
    "specific_sliding",
    "teeth_in_a_row",
    "thickness_per_tooth",
    "thinned",
    "tooth_section",
    "traces",
    "transmission_error",
    "waterfall",
    "wear_maps",
    "worn_profile",
]
