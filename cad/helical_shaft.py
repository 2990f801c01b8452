"""build123d: a helical pinion cut on its shaft.

Run it in CQ-editor, in VS Code with the OCP viewer, or with plain Python. The flanks stay exact: the shaft is
joined to the end faces and does not touch them.
"""

# %% Numbers
from math import pi
from pathlib import Path

from build123d import Cylinder, Pos

from gearwear.brep.solid import gear_solid
from gearwear.design import read_design

HERE = Path(__file__).parent if "__file__" in globals() else Path.cwd()  # CQ-editor stands in the script's folder
DESIGN = HERE.parent / "models" / "helical_pair.toml"
PART = "pinion"
JOURNAL = 20.0  # mm, diameter on either side; below the root diameter
LENGTH = 30.0  # mm beyond each end face

# %% The gear, exact
gear = read_design(DESIGN).gears[PART]
blank = gear_solid(gear)

# %% The shaft
part = blank
for end, way in ((0.0, -1.0), (gear.face_width, 1.0)):
    part = part + Pos(0.0, 0.0, end + 0.5 * way * LENGTH) * Cylinder(0.5 * JOURNAL, LENGTH)
part.label = PART

# %% Show
hand = gear.spec.hand
print(f"{PART}, {hand} hand, lead {2.0 * pi / abs(gear.twist):.3f} mm, on its shaft: {part.volume:.1f} mm³")
if "show_object" in globals():  # CQ-editor
    show_object(part.wrapped, name=PART, options={"color": "lightsteelblue"})  # noqa: F821
else:
    try:
        from ocp_vscode import show
    except ImportError:
        pass  # no viewer: the numbers above are all
    else:
        show(part, names=[PART], colors=["lightsteelblue"])
