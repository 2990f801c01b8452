"""Ranges, sections and circles by options: what they become, and what is refused."""

import math

import pytest

from gearwear.commands.inspect import _settings, parser
from gearwear.errors import InputError
from gearwear.inspection.tolerances import Edition


def settings(gear, *words):
    return _settings(parser().parse_args(list(words)), gear, Edition.ISO_2013)


def test_options_become_settings_in_roll_and_z(pinion):
    one = settings(
        pinion, "--profile-diameters-mm", "74,88", "--slope-length-mm", "20", "--profile-z-mm", "5", "--profile-half-width-mm", "0.5",
        "--helix-diameter-mm", "76.2", "--helix-half-width-mm", "1", "--helix-z-mm", "2,12", "--pitch-diameter-mm", "80", "--helix-cutoff-mm", "0.8",
    )  # fmt: skip
    base = pinion.base_radius
    assert (one.control_roll, one.profile_end) == pytest.approx((math.sqrt(37**2 - base**2), math.sqrt(44**2 - base**2)))
    assert one.profile_band == (4.5, 5.5)
    assert one.helix_band == pytest.approx((math.sqrt(38.1**2 - base**2) - 1.0, math.sqrt(38.1**2 - base**2) + 1.0))
    assert (one.slope_length, one.helix_between, one.helix_cutoff) == (20.0, (2.0, 12.0), 0.8)
    assert one.pitch_roll == pytest.approx(math.sqrt(40**2 - base**2))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--profile-roll-mm", "1,40"), "the involute goes from"),
        (("--pitch-diameter-mm", "95"), "the involute goes from"),
        (("--helix-z-mm", "20,30"), "the face goes from 0 to 15 mm"),
        (("--helix-z-mm=-1,12",), "--helix-z-mm -1,12: the face goes from 0 to 15 mm"),
        (("--pitch-z-mm", "2,15.5"), "--pitch-z-mm 2,15.5: the face goes from 0 to 15 mm"),
        (("--profile-z-mm", "15.1"), "--profile-z-mm 15.1: the face goes from 0 to 15 mm"),
        (("--helix-z-mm", "-1,12"), "joined with = where it begins with a minus sign"),
        (("--profile-half-width-mm", "1"), "needs the place of the section"),
        (("--slope-length-mm", "-1"), "--slope-length-mm -1: a length above 0 mm"),
        (("--slope-length-mm", "inf"), "--slope-length-mm inf: a length above 0 mm and at most 100000 mm would be right"),
        (("--profile-cutoff-mm", "inf"), "--profile-cutoff-mm inf: a length above 0 mm and at most"),
        (("--profile-cutoff-mm", "1e-9"), "cut-off of the profile's filter, 1e-09 mm: 0.0443 to 22.1220 mm would be right"),
        (("--helix-cutoff-mm", "100"), "cut-off of the helix's filter, 100 mm: 0.0270 to 13.5000 mm would be right"),
        (("--span-teeth", "0"), "span_teeth = 0: a whole number from 1 up"),
        (("--control-diameter", "74", "--profile-roll-mm", "5,20"), "give one of them"),
    ],
)
def test_what_does_not_fit_the_gear_is_refused(pinion, words, said):
    with pytest.raises(InputError, match=said):
        settings(pinion, *words)
