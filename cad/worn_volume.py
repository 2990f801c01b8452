"""build123d: the nominal gear, translucent, and in red the metal that is gone.

Run ``python -m gearwear.compare`` first; the script reads the worn volume from its output folder. Until then
it shows a made-up dent. Run it in CQ-editor, in VS Code with the OCP viewer, or with plain Python.
"""

# %% Numbers
from pathlib import Path

import numpy as np
from build123d import Pos, Sphere, import_stl

import gearwear
from gearwear.brep.solid import gear_solid
from gearwear.design import read_design
from gearwear.design.surface import flank_points

HERE = Path(__file__).parent if "__file__" in globals() else Path.cwd()  # CQ-editor stands in the script's folder
OUT = HERE.parent / "gearwear-out"  # where the comparison wrote
DESIGN = Path(gearwear.__file__).parent / "example" / "design.toml"
PART = "pinion"
DENT_RADIUS = 4.0  # mm, of the ball that makes the made-up dent; it must not reach the next tooth
DENT_DEPTH = 0.5  # mm

# %% The nominal gear
gear = read_design(DESIGN).gears[PART]
nominal = gear_solid(gear)

# %% What is gone
stl = OUT / "worn_volume.stl"
if stl.is_file():
    worn = import_stl(stl)
    print(f"{stl}: {worn.bounding_box().size.Z:.2f} mm along the axis")
else:
    print(f"{stl} is not there yet (python -m gearwear.compare writes it): this is a made-up dent")
    middle = flank_points(gear, *map(np.array, ([0], [1], [gear.reference_roll], [0.5 * gear.face_width])))
    centre = middle.position[0] + (DENT_RADIUS - DENT_DEPTH) * middle.normal[0]
    worn = nominal & Pos(*centre) * Sphere(DENT_RADIUS)
    print(f"made-up dent of {worn.volume:.2f} mm³")

# %% Show
if "show_object" in globals():  # CQ-editor, where alpha is transparency
    show_object(nominal.wrapped, name="nominal", options={"color": "lightsteelblue", "alpha": 0.7})  # noqa: F821
    show_object(worn.wrapped, name="worn volume", options={"color": "red"})  # noqa: F821
else:
    try:
        from ocp_vscode import show
    except ImportError:
        pass  # no viewer: the numbers above are all
    else:  # here it is opacity
        show(nominal, worn, names=["nominal", "worn volume"], colors=["lightsteelblue", "red"], alphas=[0.3, 1.0])
