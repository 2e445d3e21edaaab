"""Features of a record's response, by the method that suits it: force steps, a free decay, or none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from msd_ident.data.noise import Noise, noise_of
from msd_ident.data.onsets import Onset, is_constant, onsets
from msd_ident.data.record import Record
from msd_ident.features.decay import free_decay
from msd_ident.features.form import StandardForm, combine, combine_chain, pool
from msd_ident.features.let_go import let_go
from msd_ident.features.response import Response, step_response, with_dead_width

Kind = Literal["step", "free_decay", "none"]


@dataclass(frozen=True)
class Features:
    """What a record's response shows without a fit of a model.

    Attributes:
        kind: ``step``, ``free_decay``, or ``none`` when neither applies.
        route: a sentence on how the standard form was found, or why there is none.
        responses: one for each force step (or one for the free decay), in time order.
        standard_form: of all responses together; ``None`` without any.
        remarks: what a reader must know about the features, a sentence each.
        freed: instant [s] from which on models are fitted, as a hand held or pulled the cart before; None: the first.
    """

    kind: Kind
    route: str
    responses: tuple[Response, ...]
    standard_form: StandardForm | None
    remarks: tuple[str, ...] = ()
    freed: float | None = None

    @property
    def two_peak_form(self) -> StandardForm | None:
        """ωn and ζ of the paper's two peaks alone, eqs. 3 to 7, all responses together; ``None`` without two peaks.

        With dry friction, which damps the small swings most, these are nearer to the viscous ζ than all peaks are.
        """
        peaks = [response.peaks for response in self.responses if response.peaks is not None]
        if self.standard_form is None or not peaks:
            return None
        return StandardForm(
            combine([pair.natural_frequency for pair in peaks]),
            combine([pair.damping_ratio for pair in peaks]),
            self.standard_form.static_gain,
        )


def extract(record: Record) -> Features:
    """Features of a record: steps up and down of either sign, a free decay, or a sentence why there are none."""
    noise = noise_of(record)
    steps, constant = onsets(record), is_constant(record)
    responses = _responses(record, steps, noise)
    if responses:
        return Features(
            "step", _step_route(responses), responses, _together(responses), _left_out(record, steps, responses)
        )
    if constant:
        return _decay(record, noise)
    if steps:
        count = f"{len(steps)} force step{'s' if len(steps) > 1 else ''}"
        return _none(f"{count}, but no response that settles or swings: a step response does not apply.")
    return _none("The force is never held for long: a step response does not apply, and the model is fitted instead.")


def _none(why: str) -> Features:
    return Features("none", why, (), None)


def _responses(record: Record, steps: Sequence[Onset], noise: Noise) -> tuple[Response, ...]:
    """Responses in turn; one that shows nothing breaks the chain, and the next must begin at rest again."""
    found: list[Response] = []
    earlier: Response | None = None
    for onset in steps:
        earlier = step_response(record, onset, noise, earlier)
        if earlier is not None:
            found.append(earlier)
    return with_dead_width(tuple(found))


def _together(responses: Sequence[Response]) -> StandardForm | None:
    """ωn and ζ as weighted means, K from all rest values: a rest value ends one step and begins the next."""
    form = pool(response.form for response in responses)
    gains = [response.form.static_gain for response in responses if response.form and response.form.static_gain]
    if form is None or len(gains) < len(responses):
        return form
    links = [
        -(one.steady_state.std**2) / (one.amplitude * two.amplitude) if two.initial == one.steady_state else 0.0
        for one, two in zip(responses, responses[1:], strict=False)
    ]
    return StandardForm(form.natural_frequency, form.damping_ratio, combine_chain(gains, links))


def _left_out(record: Record, steps: Sequence[Onset], responses: Sequence[Response]) -> tuple[str, ...]:
    counted = {response.onset for response in responses}
    begin = float(record.time[0])  # A record that begins under a force need not begin with a step.
    skipped = sum(onset.time > begin and onset.time not in counted for onset in steps)
    if not skipped:
        return ()
    return (
        f"{skipped} force step{'s' if skipped > 1 else ''} left out: no rest before, or too little motion soon after.",
    )


def _step_route(responses: tuple[Response, ...]) -> str:
    swinging = sum(response.shape is None for response in responses)
    turns = sum(len(response.turns) for response in responses)
    many = f"{len(responses)} force step{'s' if len(responses) > 1 else ''}"
    if swinging == len(responses):
        return f"Standard form from {turns} turning points after {many}, eqs. 3 to 9."
    if swinging == 0:
        return (
            f"Fewer than three clear turning points after {many}, so no decrement: standard form from a least-squares "
            "fit of the whole step response, eq. 10."
        )
    return (
        f"Standard form after {many}: {swinging} by turning points, eqs. 3 to 9, {len(responses) - swinging} by a "
        "least-squares fit of the whole response, eq. 10."
    )


def _decay(record: Record, noise: Noise) -> Features:
    response = free_decay(record, noise)
    if response is None:
        acts = "The force never changes" if record.force.any() else "No force acts"
        still = _none(f"{acts} and nothing swings: there is no response to read.")
        freed = let_go(record, noise)
        return still if freed is None else replace(still, remarks=_held(record, freed), freed=freed)
    route = (
        f"Free decay from {len(response.turns)} turning points, eqs. 3 to 7: without a force there is no static gain, "
        "so mass, damping and stiffness are known only as ratios."
    )
    remarks = _held(record, response.onset)
    return Features("free_decay", route, (response,), pool((response.form,)), remarks, response.onset)


def _held(record: Record, freed: float) -> tuple[str, ...]:
    """A sentence on a good part of a record before the cart is free."""
    lead = freed - float(record.time[0])
    if lead <= 0.02 * record.duration:
        return ()
    return (
        f"The first {lead:.2f} s, before the cart moved freely, were left out: it was held or pulled by hand. "
        "Give --start to begin later.",
    )
