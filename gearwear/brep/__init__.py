"""Design to exact solids and STEP files; the only room that imports build123d and OCP.

Nothing is imported here, so that `curves` and `outline` can be used without the CAD kernel.
"""
