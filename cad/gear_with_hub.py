"""CadQuery: read the gear from its STEP file and give it a hub, a bore and a chamfer.

Run it in CQ-editor, in VS Code with the OCP viewer, or with plain Python. It needs nothing of gearwear but the file.
"""

# %% Numbers
from pathlib import Path

import cadquery as cq

HERE = Path(__file__).parent if "__file__" in globals() else Path.cwd()  # CQ-editor stands in the script's folder
MODEL = HERE.parent / "models" / "paper_pair" / "gear.step"
HUB_DIAMETER = 60.0  # mm
HUB_LENGTH = 12.0  # mm beyond the face
BORE = 32.0  # mm
CHAMFER = 1.5  # mm on the hub's outer edge

# %% The gear
gear = cq.importers.importStep(str(MODEL))
face_width = gear.val().BoundingBox().zmax

# %% The hub, then the bore through both
hub = cq.Workplane("XY").workplane(offset=0.5 * face_width).circle(0.5 * HUB_DIAMETER).extrude(0.5 * face_width + HUB_LENGTH)
hub = hub.faces(">Z").edges().chamfer(CHAMFER)
bore = cq.Workplane("XY").circle(0.5 * BORE).extrude(face_width + HUB_LENGTH)
part = gear.union(hub).cut(bore)

# %% Show
print(f"gear with hub {HUB_DIAMETER:g} x {HUB_LENGTH:g} mm and bore {BORE:g} mm: {part.val().Volume():.1f} mm³")
if "show_object" in globals():  # CQ-editor
    show_object(part, name="gear", options={"color": "wheat"})  # noqa: F821
else:
    try:
        from ocp_vscode import show
    except ImportError:
        pass  # no viewer: the numbers above are all
    else:
        show(part, names=["gear"], colors=["wheat"])
