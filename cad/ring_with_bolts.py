"""build123d: a ring gear with bolt holes in its rim.

Run it in CQ-editor, in VS Code with the OCP viewer, or with plain Python. The flanks stay exact: the holes are
cut between the root circle and the outside, and do not touch them.
"""

# %% Numbers
from pathlib import Path

from build123d import Cylinder, PolarLocations, Pos

from gearwear.brep.solid import gear_solid
from gearwear.design import read_design

HERE = Path(__file__).parent if "__file__" in globals() else Path.cwd()  # CQ-editor stands in the script's folder
DESIGN = HERE.parent / "models" / "ring_pair.toml"
PART = "gear"
HOLES = 6
HOLE_DIAMETER = 4.0  # mm

# %% The ring, exact
gear = read_design(DESIGN).gears[PART]
part = gear_solid(gear)

# %% The holes, in the middle of the rim
middle = 0.5 * (gear.root_radius + gear.body_radius)
for place in PolarLocations(middle, HOLES):
    part = part - place * Pos(0.0, 0.0, 0.5 * gear.face_width) * Cylinder(0.5 * HOLE_DIAMETER, gear.face_width)
part.label = PART

# %% Show
print(f"{PART}, {gear.teeth} teeth inwards, {HOLES} holes on a circle of {2.0 * middle:.2f} mm: {part.volume:.1f} mm³")
if "show_object" in globals():  # CQ-editor
    show_object(part.wrapped, name=PART, options={"color": "lightsteelblue"})  # noqa: F821
else:
    try:
        from ocp_vscode import show
    except ImportError:
        pass  # no viewer: the numbers above are all
    else:
        show(part, names=[PART], colors=["lightsteelblue"])
