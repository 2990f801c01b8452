"""Every threshold of the diagnosis: value, unit, origin and reason. The functions read them here, so that one can be varied at a time.

`docs/rules.md` is made of this class and of what `benchmarks/sensitivity.py` measured.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any, TypeVar

T = TypeVar("T")


def rule(value: T, unit: str, origin: str, why: str, off: Any = None) -> T:
    """A field of `Rules`.

    Parameters
    ----------
    value : T
        The default.
    unit : str
        What it is counted in; "1" for a ratio.
    origin : str
        "derived", "literature: …", "numerical", or "tuned: …" with the scans.
    why : str
        One line.
    off : object
        Value at which the rule does nothing; None where there is none.
    """
    one: T = field(default=value, metadata={"unit": unit, "origin": origin, "why": why, "off": off})
    return one


@dataclass(frozen=True, slots=True, kw_only=True)
class Rules:
    """The thresholds."""

    # The fit.
    caution: tuple[float, ...] = rule(
        (3.0, 1.5, 1.0, 1.0),
        "1",
        "tuned, scans not recorded",
        "factor on the wear limit, round by round: effects explain first, what is left may then be wear",
        off=(1.0, 1.0, 1.0, 1.0),
    )
    first_unit: float = rule(
        3.0,
        "1",
        "tuned, scans not recorded",
        "gain of a column that explains nothing, before the correlation of the scan is known",
        off=1.0,
    )
    first_correlation: float = rule(
        0.3,
        "noise, and 1",
        "tuned, scans not recorded",
        "texture taken for granted in the first round, and its correlation from cell to cell",
        off=0.0,
    )
    longest_lag: int = rule(8, "cells", "tuned, scans not recorded", "distance over which correlation is followed")
    least_correlation: float = rule(0.05, "1", "tuned, scans not recorded", "below it the sum of correlations stops", off=-1.0)
    unit_picks: int = rule(40, "columns", "numerical", "columns of which the median gain is taken")
    fewest_points: float = rule(2.0, "points", "derived", "a cell of one point has no scatter", off=1.0)
    least_count: float = rule(
        0.25, "usual count", "tuned, scans not recorded", "a cell with fewer points lies half on something else", off=0.0
    )
    edge: float = rule(
        0.12,
        "modules",
        "derived",
        "roll left out above the form circle: there dL = (r / L) dr turns a radial error into millimetres of roll",
        off=0.0,
    )
    fewest_tip_columns: int = rule(
        4, "columns", "tuned, scans not recorded", "from which on the outer two of a tip land can be spared", off=1_000_000
    )
    whole: float = rule(
        0.25,
        "1",
        "tuned: scans with a few flanks worn beside errors of the table",
        "share of a flank that looks worn from which on none of it tells of pitch",
        off=1.0,
    )
    most_worn: float = rule(
        0.5,
        "1",
        "derived",
        "share of the flanks of a side that may be worn apart from the others: what most flanks have is how they were made",
        off=0.0,
    )
    known_flank: float = rule(
        0.5, "usual cells", "tuned, scans not recorded", "share of the cells of a flank from which on its level is known", off=0.0
    )
    beyond_doubt: float = rule(
        0.05,
        "of the cost",
        "tuned: 24 gears of 25 to 80 teeth, worn on no side, one or both",
        "by how much other sides worn must cost more at a first look for that not to be asked again: it has chosen wrongly at 2 %",
        off=math.inf,
    )
    least_held: float = rule(
        0.01,
        "1",
        "derived: one flank in a hundred",
        "share of what a scan tells of where the gear stands, which way it is told least, that must be left without flanks that look worn",
        off=-math.inf,
    )
    least_between: float = rule(
        0.1,
        "of the flank's roll",
        "derived: reliefs leave an involute between them",
        "how much of the flank a tip and a root relief must leave between them to be no sliding wear of both sides",
        off=-math.inf,
    )
    untold_flank: float = rule(
        0.1,
        "1",
        "tuned: ground gears with a hollow flank",
        "share of a flank's cells that the fit used, below which it is none's datum",
        off=0.0,
    )
    sound_flank: float = rule(
        0.3,
        "1",
        "tuned: ground gears with a hollow flank",
        "and above which it may be left out in turn to see what the rest of its tooth tells of it",
        off=0.0,
    )
    rows_of_sides: int = rule(
        8,
        "rows",
        "tuned: family g of benchmarks/families",
        "rows of cells that are left where sides worn throughout are chosen on fewer cells",
        off=1_000_000,
    )
    stray_scale: float = rule(
        2.0, "robust scales", "literature: Tukey biweight", "cells farther off than this times its cut-off are torn", off=math.inf
    )
    folds_of_teeth: int = rule(
        12,
        "folds",
        "derived",
        "groups of teeth that are left out in turn; of at least half as many that divide the teeth the nearest",
    )
    blocks: int = rule(6, "folds", "derived", "blocks along z or the profile, staggered from tooth to tooth")

    # The search.
    effect_penalty: float = rule(7.0, "cost", "derived", "2 ln of some candidates: what an effect must be worth beyond chance")
    parameter_penalty: float = rule(4.0, "cost", "derived", "2 standard deviations: each of its parameters")
    shape_price: float = rule(1.5, "parameters", "tuned, scans not recorded", "what a shape value counts", off=1.0)

    pitch_spread: float = rule(
        0.7,
        "modules",
        "derived: shifts of a pair that sum to 0 ± 0.5, and as many teeth on either gear",
        "standard deviation of how far the pitch point lies off the reference circle, of roll, where the design has no mate",
        off=0.0,
    )
    pitch_within: float = rule(
        0.15,
        "of the flank",
        "derived: a loss has two sides of it",
        "how far within the ends of the flank the pitch point is looked for",
    )

    tried: int = rule(3, "candidates", "tuned, scans not recorded", "those of greatest gain are tried in each place", off=0)

    # The judgement.
    significance: float = rule(
        0.01, "p", "literature: family-wise level, Bonferroni", "greatest p, corrected for all that was tried", off=1.0
    )
    significance_of_names: float = rule(
        0.001,
        "p",
        "tuned: seed 31415 of the study, where three of four false names had 0.002 to 0.007",
        "the same of an effect, by the covariance of the cells, which is a model: what left-out teeth show has the level above",
        off=1.0,
    )
    errors: float = rule(
        3.0,
        "standard errors",
        "derived",
        "what chance does not do: least gain on left-out teeth, difference between halves; its square is the cost that parts models",
        off=-math.inf,
    )
    least_share: float = rule(
        0.06,
        "noise",
        "tuned, scans not recorded",
        "least contribution of an effect, least size of a pattern, root mean square",
        off=0.0,
    )
    least_of_largest: float = rule(
        0.01,
        "1",
        "tuned, scans not recorded",
        "least contribution in units of the model's: below it the second order of a large effect looks like one of its own",
        off=0.0,
    )
    left_of_it: float = rule(
        0.5,
        "1",
        "tuned: of 41 scans of two generators named effects that are there keep 0.7 and more, on the sides of teeth or off them, invented ones 0.4 and less",
        "share of an effect that must be left once the others are added, on the sides of teeth or off them: else they take each other back",
        off=-math.inf,
    )
    surface_share: float = rule(
        0.05,
        "1",
        "derived: a coat has a sixth of its square off the sides of teeth",
        "share of its square that an effect must have on the sides of teeth, or off them, for these to speak for it",
        off=0.0,
    )
    more_parameters: int = rule(
        3,
        "parameters",
        "tuned, scans not recorded",
        "most that an alternative may have beyond the named effect's",
        off=1_000_000,
    )
    same: float = rule(
        0.97,
        "1",
        "tuned, scans not recorded",
        "share of what the named effect explains from which another cannot be told from it",
        off=2.0,
    )

    moved: float = rule(
        0.8,
        "1",
        "derived",
        "share of an effect that rigid motions of quarters of the gear explain from which views may have left it: helix slope, wobble and waves to the second"
        " order have 0.84 and more, coat, taper, scale and forms 0.46 at most",
        off=2.0,
    )
    stands_in: float = rule(
        0.5,
        "1",
        "derived",
        "share of what an effect explains that may be left to it beside what stands in its place: less than half",
        off=math.inf,
    )

    # What does not stand.
    cancelled: float = rule(
        0.1,
        "1",
        "tuned, scans not recorded",
        "share of its own size that an effect must explain: else others take nearly all of it back",
        off=0.0,
    )
    bent: float = rule(
        0.4,
        "1",
        "tuned: without it a real gear (kw_199) is hollow by 12 µm on a side whose form is 3 µm",
        "several effects that each explain less than this share of their size draw a curve that none of them is",
        off=0.0,
    )
    several: int = rule(3, "effects", "tuned, scans not recorded", "namely so many")
    uneven: float = rule(
        0.4,
        "1",
        "tuned, scans not recorded",
        "difference of relative size between two halves of the gear from which an effect is a piece of something else",
        off=math.inf,
    )
    free_share: float = rule(
        0.3, "1", "tuned, scans not recorded", "share of the difference that other effects must leave free", off=0.0
    )
    makeshift: float = rule(
        2.0,
        "1",
        "tuned, scans not recorded",
        "an effect that explains less than so many times a left pattern of its order is a piece of it",
        off=0.0,
    )
    own_order: float = rule(0.5, "1", "derived", "share of an effect that is of one order: most of it", off=0.0)

    # What no effect explains.
    most_patterns: int = rule(3, "patterns", "tuned, scans not recorded", "most that are reported", off=1_000_000)
    smoothings: tuple[float, ...] = rule(
        (0.6, 1.5, 3.0),
        "cells",
        "tuned, scans not recorded",
        "Gaussian widths of a pattern's map; teeth left out say which",
        off=(1.5,),
    )
    pattern_rows: int = rule(3, "rows", "derived", "fewest rows of cells")
    pattern_teeth: int = rule(6, "teeth", "derived", "fewest teeth")
    pattern_floor: float = rule(
        0.2, "1", "tuned, scans not recorded", "least power at a frequency, in that of the median frequency", off=0.0
    )
    freedom_share: float = rule(
        0.5, "1", "tuned, scans not recorded", "freedoms left to neighbouring coefficients that texture ties together"
    )
    even_share: float = rule(
        0.2,
        "1",
        "tuned, scans not recorded",
        "share of its square that varies, below which a pattern is even that way, and an effect on the flanks",
        off=0.0,
    )
    one_sided: float = rule(
        0.3,
        "1",
        "tuned, scans not recorded",
        "size on one side in that on the other, below which it is on one side only",
        off=0.0,
    )
    alike: float = rule(0.6, "1", "tuned, scans not recorded", "correlation of the sides from which they go together")

    # Worn throughout.
    blank_flanks: float = rule(
        0.25,
        "1",
        "tuned: families g and l of benchmarks/families",
        "share of a side's flanks that may show nothing of what they have in common: what a view shows alone is no wear throughout",
        off=1.0,
    )

    alike_teeth: float = rule(
        0.1,
        "1",
        "tuned: 17 real ground gears (0.02 to 0.09), family k of benchmarks/families (0.13 to 0.28)",
        "standard deviation of the teeth's shares of a loss, in their mean, below which all teeth may have been cut so",
        off=0.0,
    )
    active_face: float = rule(
        1.0 / 3.0,
        "of the face",
        "derived",
        "width of where the mate ran, at least: less is a groove, or an end that is rounded",
    )
    margin_rows: int = rule(
        2,
        "rows",
        "derived",
        "rows of cells beside where the mate ran, at least: one is an edge, which may be rounded or carry a burr",
    )
    least_load: float = rule(
        1.0 / 6.0,
        "1",
        "derived: a third of the load, at half of the specific sliding in proportion to the way",
        "what a place of a worn flank has lost at least, in proportion to its way from the pitch point, of what one nearer to it has",
        off=0.0,
    )
    least_way: float = rule(
        0.2,
        "1",
        "derived: at the pitch point nothing slides, and a loss tells no load",
        "share of the farthest way from the pitch point from which on a loss tells the load",
        off=1.0,
    )
    ground_class: int = rule(
        5,
        "class",
        "literature: usual of ground gears (ISO 1328-1)",
        "flank class whose f_fα a place may lack of that all the same",
        off=12,
    )
    proud: float = rule(
        0.5,
        "1",
        "derived",
        "share of an even loss by which a worn side may stand proud of it: 0 where teeth are thin, 1 where the other side alone has lost it",
        off=math.inf,
    )

    # Uncertainty and strong effects.
    hidden: float = rule(
        0.4, "limit of detection", "tuned, scans not recorded", "typical size of an effect too small to be found", off=0.0
    )
    spanned: float = rule(
        1e-3, "1", "numerical", "share of its square below which the model already stands for an effect", off=0.0
    )
    form_error: float = rule(
        0.003,
        "1",
        "tuned, scans not recorded",
        "share of its own size to which an effect's form is trusted: first order, means over cells",
        off=0.0,
    )
    form_error_with_shape: float = rule(0.01, "1", "tuned, scans not recorded", "the same with shape values", off=0.003)
    distorted: float = rule(
        0.02,
        "modules",
        "tuned, scans not recorded",
        "root mean square deviation above which the scan is located again",
        off=math.inf,
    )
    carried: float = rule(
        0.005,
        "modules",
        "derived",
        "and how far points were carried off: twice its square over the module is left on a fillet",
        off=math.inf,
    )

    @property
    def close(self) -> float:
        """Cost within which two models cannot be told apart."""
        return self.errors**2


RULES = Rules()
"""As the program uses them."""

_CURRENT: ContextVar[Rules] = ContextVar("rules", default=RULES)


def rules() -> Rules:
    """Those in force: `RULES`, but inside `in_force`."""
    return _CURRENT.get()


@contextmanager
def in_force(these: Rules) -> Iterator[None]:
    """Other rules inside a `with`, for tests and studies: `with in_force(replace(RULES, close=4.0)): …`."""
    token = _CURRENT.set(these)
    try:
        yield
    finally:
        _CURRENT.reset(token)
