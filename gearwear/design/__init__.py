"""The nominal gear: specification, exact geometry, and where a point belongs on it. numpy only."""

from gearwear.design.files.toml import parse_design, read_design
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.design.spec import Baseline, GearSpec, PairSpec

__all__ = ["Baseline", "Design", "Gear", "GearSpec", "PairSpec", "parse_design", "read_design"]
