"""Effects that the measured data would not show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from designrigs import LIMITS, Rig

from msd_ident.design import Profile, Segment, check
from msd_ident.design.hidden_effects import hidden
from msd_ident.design.prediction import sensing
from msd_ident.workflow import pipeline


@pytest.mark.parametrize(
    ("counts", "half_width"),
    [(42e3, 1e-4), *(pytest.param(*rig, marks=pytest.mark.long) for rig in ((42e3, 3e-4), (80e3, 1.5e-4)))],
)
def test_a_play_in_which_the_cart_began_hides_at_its_very_size(
    counts: float, half_width: float, asking_about: Callable[..., None]
) -> None:
    """A step ends beyond the play: a softer plain spring fits as well. Smaller plays than the true one fit worse."""
    asking_about("backlash", "end_stop", "bilinear_spring", "cubic_spring", "coulomb_friction")
    rig = Rig({"counts_per_metre": counts}, backlash={"backlash_half_width": half_width})
    first = Profile((Segment("hold", 0.3), Segment("step", 2.7, force=8.0)), "one step")
    diagnosis = pipeline.diagnose([rig.play(first, LIMITS).record])
    assert diagnosis.verdict == "adequate"
    lead, *hiding = hidden(diagnosis, sensing(diagnosis.records, diagnosis.noise_floor))
    assert lead.causes == ()
    (play,) = [rival for rival in hiding if rival.causes == ("backlash",)]
    assert play.model["backlash_half_width"] > 0.5 * half_width
    proposal = check(diagnosis, replace(LIMITS, duration=8.0))
    assert proposal is not None
    together = pipeline.diagnose([*diagnosis.records, rig.play(proposal.profile, LIMITS).record])
    assert together.verdict == "explained" and [cause.name for cause in together.causes] == ["backlash"]
