"""The paper reproduced: every number it prints, made again, and what is behind the difference.

Kumar, Jain and Pathak, ICPME'2014, pp. 57-61, doi 10.15242/IAE.IAE1214203: wear of a 12-tooth pinion from two laser scans.
``python -m gearwear.paper`` prints the table, ``--json`` the rows, ``--markdown`` the page ``docs/paper.md``.
"""

from gearwear.paper.explain import Case, Cause, Row, Step, explain
from gearwear.paper.page import as_markdown
from gearwear.paper.rows import chapters, rows

__all__ = ["Case", "Cause", "Row", "Step", "as_markdown", "chapters", "explain", "rows"]
