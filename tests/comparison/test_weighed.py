"""The scale beside the scan."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from gearwear.comparison.weighed import WeighedLoss, weighed_loss
from gearwear.design import parse_design
from gearwear.design.weighing import WeighingSpec
from gearwear.errors import InputError
from gearwear.report.words.verdict import weighed_words

GEAR = {"teeth": 20, "module": 2.0, "face_width": 10.0}
STATED = {"before_g": 812.403, "after_g": 812.144, "std_g": 0.002, "material": "steel"}


def test_a_cubic_centimetre_of_steel():
    spec = parse_design({"gear": GEAR, "weighing": {**STATED, "before_g": 107.85, "after_g": 100.0}}).weighing
    assert spec is not None
    volume, std = spec.lost_volume
    assert volume == pytest.approx(1000.0)
    # 2 mg twice in 7.85 g/cm³ are 0.36 mm³; 1 % of the density is 10 mm³
    assert std == pytest.approx(math.hypot(2.0 * math.sqrt(2.0) / 7.85, 10.0))


@pytest.mark.parametrize(
    ("after", "limits", "agrees", "difference"),
    [
        (100.0 - 0.0785, None, True, 0.0),
        (100.0 - 0.0785 * 1.5, None, False, 5.0),
        (100.0 - 0.0785 * 1.5, (9.0, 15.5), True, 0.0),
        (100.0 - 0.0785 * 0.5, (9.0, 15.5), False, -4.0),
        (100.1, None, False, -10.0 - 100.0 / 7.85),
    ],
)
def test_agreement_is_judged_from_the_nearest_limit(after, limits, agrees, difference):
    loss = weighed_loss(WeighingSpec(100.0, after, 0.0005, 7.85), (10.0, 0.2), limits)
    assert loss.agrees is agrees
    assert loss.difference == pytest.approx(difference, abs=1e-9)


def test_how_often_the_true_volume_is_called_wrong():
    """Both with normal errors of the stated sizes: 5 % in 4,000 draws, within three binomial deviations."""
    rng = np.random.default_rng(4)
    apart, draws = 0, 4000
    for _ in range(draws):
        density = 7.85 * (1.0 + 0.01 * rng.normal())
        before, after = 100.0 + 0.002 * rng.normal(), 100.0 - 1e-3 * 30.0 * density + 0.002 * rng.normal()
        scanned = (30.0 + 0.4 * rng.normal(), 0.4)
        apart += not weighed_loss(WeighingSpec(before, after, 0.002, 7.85), scanned, None).agrees
    assert apart / draws == pytest.approx(0.05, abs=3.0 * math.sqrt(0.05 * 0.95 / draws))


def test_the_words():
    assert weighed_words(None) == []
    same = weighed_words(WeighedLoss(0.0785, (10.0, 0.1), (10.1, 0.2), 10.1, 10.1))
    assert "agrees with the scan" in same[0] and "78.5" in same[0]
    gained = weighed_words(WeighedLoss(-0.0785, (-10.0, 0.1), (12.0, 0.2), 12.0, 12.0))
    assert "the gear became heavier by 78.5" in gained[0] and "are gone" not in gained[0]
    other = weighed_words(WeighedLoss(0.0785, (10.0, 0.1), (12.0, 0.2), 12.0, 12.0))
    assert "less than the scan says" in other[0] and "8.94 standard deviations" in other[0]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"before_g": None}, "[weighing] before_g is missing"),
        ({"material": None}, "material and density_g_cm3 are both missing"),
        ({"density_g_cm3": 7.8}, "material and density_g_cm3 are both given"),
        ({"material": "stel"}, "material = 'stel' is unknown (steel?)"),
        ({"std_g": 0.0}, "std_g = 0 g: must lie from 1e-09"),
        ({"after_g": float("nan")}, "after_g = nan: must be a finite number"),
        ({"before": 1.0}, "before is unknown (before_g?)"),
        ({"density_std_percent": 51.0}, "density_std_percent = 51 %"),
    ],
)
def test_what_cannot_be_is_refused(values, message):
    table = {key: value for key, value in {**STATED, **values}.items() if value is not None}
    with pytest.raises(InputError, match=re.escape(message)) as refused:
        parse_design({"gear": GEAR, "weighing": table})
    assert "\n" not in str(refused.value)
