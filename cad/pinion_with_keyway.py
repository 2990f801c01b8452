"""build123d: the pinion of a design with a bore and a keyway.

Run it in CQ-editor, in VS Code with the OCP viewer, or with plain Python. The flanks stay exact: a
Boolean cuts away metal elsewhere and does not touch them.
"""

# %% Numbers
from dataclasses import replace
from pathlib import Path

from build123d import Box, Pos

import gearwear
from gearwear.brep.solid import gear_solid
from gearwear.design import Gear, read_design

DESIGN = Path(gearwear.__file__).parent / "example" / "design.toml"
PART = "pinion"
BORE = 30.0  # mm
KEY_WIDTH = 8.0  # mm; DIN 6885 sheet 1 for shafts above 22 up to 30 mm
KEY_DEPTH = 3.3  # mm beyond the bore

# %% The gear, exact, with its bore
design = read_design(DESIGN)
gear = Gear.from_spec(replace(design.gears[PART].spec, bore_diameter=BORE))
blank = gear_solid(gear)

# %% The keyway, on +y
reach = 0.5 * BORE + KEY_DEPTH
part = blank - Pos(0.0, 0.5 * reach, 0.5 * gear.face_width) * Box(KEY_WIDTH, reach, gear.face_width)
part.label = PART

# %% Show
print(f"{PART} with bore {BORE:g} mm and keyway {KEY_WIDTH:g} x {KEY_DEPTH:g} mm: {part.volume:.1f} mm³")
if "show_object" in globals():  # CQ-editor
    show_object(part.wrapped, name=PART, options={"color": "lightsteelblue"})  # noqa: F821
else:
    try:
        from ocp_vscode import show
    except ImportError:
        pass  # no viewer: the numbers above are all
    else:
        show(part, names=[PART], colors=["lightsteelblue"])
