"""What makes the interval of the thinnest tooth wide has its words: beside the number, and in ``report.json``."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.quantity import NORMAL_95, SPACE
from gearwear.report.records.comparison import document
from gearwear.report.words.verdict import key_figures
from gearwear.wear.by_surfaces import WIDER, SurfaceTeeth
from gearwear.wear.thickness import SectionThickness
from gearwear.wear.tooth_summary import DriftSeam, ThinnestTooth, UnmeasuredTeeth, Wider
from tests.report.fake import bare_results, changed, fake_results, fake_thickness
from tests.report.test_schema import schema, validator

WORN = fake_thickness({2: 1.58})
ARC = float(WORN.arc[1, 0])
"""mm; of the thinnest tooth, the same in all sections, to a few micrometres."""


def with_hollow() -> SectionThickness:
    """One section 0.4 mm lower, between the places that are looked at side by side: whether the least lies so low, few sections do not tell."""
    arc = WORN.arc.copy()
    arc[1, 1] -= 0.4
    return replace(WORN, arc=arc)


def by_surfaces() -> SectionThickness:
    """Surfaces that say the same as sections do, but may be 0.3 mm too high."""
    shape = (1, len(WORN.z))
    arc, std = np.full(shape, ARC), np.full(shape, 0.3 / (NORMAL_95 * WIDER))
    return replace(WORN, pooled=1, surfaces=SurfaceTeeth(np.array([1]), arc, std, np.zeros(1)))


def few_sections() -> SectionThickness:
    """A tooth of which the surfaces say 0.2 to 0.3 mm less."""
    other = ThinnestTooth(5, ARC - 0.25, 0.025, ARC - 0.3, ARC - 0.2, 4.0, WORN.nominal)
    return replace(WORN, unmeasured=UnmeasuredTeeth((other,), other))


REASONS = [
    (Wider.HOLLOW, with_hollow(), ARC - 0.4, None),
    (Wider.HOLLOW, by_surfaces(), ARC - 0.3, None),
    (Wider.PITS, replace(WORN, pit_bottom=8.0), 8.0, None),
    (Wider.FEW, few_sections(), ARC - 0.3, None),
    (Wider.EITHER, replace(WORN, otherwise=(-0.3, 0.0)), ARC - 0.3, None),
    (Wider.EITHER, replace(WORN, otherwise=(0.0, 0.3)), None, ARC + 0.3),
    (Wider.SEAM, replace(WORN, seam=DriftSeam(1, 0.3, ARC, ARC + 0.3)), None, ARC + 0.3),
    # The reason is that of the most of several.
    (Wider.PITS, replace(WORN, pit_bottom=8.0, otherwise=(-0.1, 0.1)), None, ARC + 0.1),
    (Wider.SEAM, replace(WORN, pit_bottom=ARC - 0.1, seam=DriftSeam(1, 0.3, ARC, ARC + 0.3)), ARC - 0.1, ARC + 0.3),
]


def test_every_reason_is_tried():
    assert {reason for reason, *_ in REASONS} == set(Wider)


@pytest.mark.parametrize(("reason", "thickness", "low", "high"), REASONS)
def test_a_wide_interval_has_its_reason_beside_it_and_in_the_report(reason, thickness, low, high):
    results = changed(fake_results(), "wear.thickness", thickness)
    told, words = document(results, ["report.json"])["thinnest"], str(reason)
    assert told["range_from"] == words and "," not in words
    valid = validator("report").evolve(schema=schema("report")["properties"]["thinnest"]).is_valid
    assert valid(told) and not valid({**told, "range_from": None})
    for end, wanted in (("low_mm", low), ("high_mm", high)):
        assert wanted is None or told[end] == pytest.approx(wanted, abs=0.012), (
            "to the standard deviation of the fake sections, ten times"
        )
    (figure,) = (one for one in key_figures(results) if one.name == "Thinnest tooth")
    assert " to " in figure.value.replace(SPACE, " ")
    assert figure.note.replace(SPACE, " ").startswith(f"tooth {told['tooth']}; {words}; at z = ")


@pytest.mark.parametrize("pit", [math.inf, ARC + 0.1])
def test_an_interval_as_wide_as_the_deviation_says_has_none(pit):
    thickness = replace(WORN, pit_bottom=pit)
    told = document(changed(fake_results(), "wear.thickness", thickness), ["report.json"])["thinnest"]
    assert "range_from" not in told
    assert [told["high_mm"] - told["value_mm"], told["value_mm"] - told["low_mm"]] == pytest.approx([1.96 * told["std_mm"]] * 2)


def test_a_section_that_is_thinnest_nowhere_has_no_reason():
    assert "range_from" not in document(bare_results(), ["report.json"])["thinnest"]
