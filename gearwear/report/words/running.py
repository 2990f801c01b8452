"""How the pair ran in words: for the verdict, the page and the terminal."""

from __future__ import annotations

import math

from gearwear.comparison.results import PairResult
from gearwear.design.quantity import MISSING, SPACE, listed, number, sentence
from gearwear.report.words.numbers import effect_title, or_words, quantity
from gearwear.running.found import Errors, FoundRunning, SecondLoop

HEAD = ("how the pair ran", "left", "on teeth left out", "on parts of the face left out", "on double contact left out")
CAPTION = (
    "Root mean square of what is left of the mean depth of the worn flanks: by the wear law alone, and with each effect added; then on what was"
    " left out of the fit. An effect round the gear is judged tooth by tooth."
)


def running_words(loop: SecondLoop) -> str:
    """What the pattern of the wear says of how the pair ran."""
    if not loop.effects:
        return "The pattern of the wear shows no effect of running beside the wear law."
    stated = loop.conditions.stated
    return f"By the pattern of the wear, {listed([_effect_words(effect, stated) for effect in loop.effects])}."


def _effect_words(effect: FoundRunning, stated: float) -> str:
    """One effect with its numbers, and what it cannot be told from; of a gap also what the design states of it, mm."""
    shown = dict(effect.parameters)
    towards = ""
    gap = shown.get("gap_um")
    if gap is not None and isinstance(gap.value, float):
        towards = f", open towards {_open_end(gap.value)}"
        if stated != 0.0:
            towards += f", where {number(abs(1e3 * stated), 0)}{SPACE}µm towards {_open_end(stated)} are stated"
        shown["gap_um"] = type(gap)(abs(gap.value), gap.std, gap.unit)
    text = effect.effect.phrase.format(**{name: quantity(item) for name, item in shown.items()})
    return text + towards + or_words(effect.alternatives)


def _open_end(gap: float) -> str:
    return "z = b" if gap > 0.0 else "z = 0"


def running_rows(loop: SecondLoop) -> list[tuple[str, ...]]:
    """Rows under `HEAD`: the law, then each effect."""
    rows = [("wear law alone", *_numbers(loop.before))]
    for effect in loop.effects:
        rows.append((f"with {effect_title(effect.name)}", *_numbers(effect.after)))
    return rows


def why_not_words(pair: PairResult | None) -> str:
    """Why it was not asked how the pair ran; "" where it was, or no wear law could be fitted either."""
    if pair is None or pair.second_loop is not None or pair.law is None or pair.law.best is None or not pair.running:
        return ""
    return sentence(f"How the pair ran was not traced: {pair.running}")


def _numbers(errors: Errors) -> tuple[str, ...]:
    in_mm = (errors.all, errors.teeth, errors.face, errors.double_contact)
    return tuple(f"{number(1e3 * error, 2)}{SPACE}µm" if math.isfinite(error) else MISSING for error in in_mm)
