"""Prepare records for a fit: findings, features, start at the release, hold and sign of the force."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from msd_ident.data import quality
from msd_ident.data.duplicates import without_duplicates
from msd_ident.data.quality import Examined, Finding
from msd_ident.data.quality.finding import Severity
from msd_ident.data.record import Record
from msd_ident.errors import DataError, UsageError
from msd_ident.estimate import FitResult, opposite_signs
from msd_ident.features import Features, StandardForm, extract, pool
from msd_ident.model import Model
from msd_ident.model.effects.law import DELAY
from msd_ident.residuals.ringdown import RingDown, ring_down
from msd_ident.workflow import force_hold, force_lead, turned_force
from msd_ident.workflow.starting_plant import plant_of, typical_plant

#: What quality finds where a unit is doubtful, or there are too few samples to follow the motion.
_DOUBTFUL = {"wrong_unit", "wrong_time_unit", "low_rate"}
#: Part of the greatest excursion from the last rest beyond which a hand, and not friction, is taken to hold the cart.
_HELD = 0.1


@dataclass(frozen=True)
class Prepared:
    """Records as models are fitted to them, and what was found out on the way.

    Attributes:
        given: as they came, without duplicates and without those in which nothing happens.
        records: without readings that no motion makes, from the release on, the force turned where K is negative. Rest
            after the motion is a part of it.
        rest_before: for each of ``records`` the rest before a hand pulled the cart, which is left out there with the
            hand: a record of its own, in the same stamps and with the same zero of the encoder; ``None`` where nothing
            was left out, or no rest came before it. What holds at rest (no disturbance moves the cart) is tested by it;
            where it rests is not, as friction holds it anywhere.
        findings: of the data.
        features: of each record.
        form: of all records together; ``None`` where no response gives one.
        warnings: what a reader must know about the data before using the numbers.
        turned: whether the force was turned.
        unheld: the records before it was decided how their force goes on between its samples; none where that is known.
    """

    given: tuple[Record, ...]
    records: tuple[Record, ...]
    findings: tuple[Finding, ...]
    features: tuple[Features, ...]
    form: StandardForm | None
    warnings: tuple[str, ...]
    rest_before: tuple[Record | None, ...]
    turned: bool = False
    unheld: tuple[Record, ...] = ()

    @property
    def asks_hold(self) -> bool:
        """Whether a diagnosed model may still decide how the force goes on between its samples, or that it leads."""
        return bool(self.unheld) and not any(record.lead > 0.0 for record in self.records)

    @property
    def doubtful_data(self) -> tuple[str, ...]:
        """Sentences of the findings on units that are doubtful, and on too few samples in an oscillation."""
        return tuple(dict.fromkeys(finding.sentence for finding in self.findings if finding.code in _DOUBTFUL))

    @cached_property
    def plant(self) -> Model:
        """The plant that fits start from: that of the standard form; without one, one of the first record's size."""
        return typical_plant(self.records[0]) if self.form is None else plant_of(self.form)

    @cached_property
    def ring_down(self) -> RingDown | None:
        """ζ(A) and ωn(A) of all responses, if they swing often enough."""
        return ring_down(self.features, self.records[0].position_unit)


def prepare(records: Sequence[Record]) -> Prepared:
    """Check the records of one experiment, and prepare them for a fit.

    Raises:
        DataError: the data cannot carry any estimate (a constant signal, for one).
        UsageError: no records, or records in different units.
    """
    _refuse_units(records)
    several, duplicates = without_duplicates(records)
    examined, idle = _examined(several)
    given, findings = tuple(one.given for one in examined), tuple(each for one in examined for each in one.findings)
    _refuse(findings)
    understood = tuple(_understood(one.record) for one in examined)
    features = tuple(one.features for one in understood)
    form = pool(found.standard_form for found in features)
    turned = _turned(form, understood)
    usable = tuple(_usable(one, turned) for one in understood)
    records, holds = _held(usable)
    warnings = (
        duplicates
        + idle
        + _warnings(given, findings, features, turned)
        + tuple(one.remark for one in understood if one.remark)
    )
    warnings += tuple(finding.sentence for finding in holds if finding.severity == "warning")
    rests = tuple(_rest_before(one, used, form) for one, used in zip(understood, records, strict=True))
    unheld = usable if any(map(force_hold.may_lead, usable)) else ()
    return Prepared(given, records, findings + holds, features, form, warnings, rests, turned, unheld)


def _held(records: tuple[Record, ...]) -> tuple[tuple[Record, ...], tuple[Finding, ...]]:
    """The records with their force as the data says it goes on between its samples, where that was open."""
    asked = tuple(record for record in records if force_hold.is_open(record))
    if not asked:
        return records, ()
    choice = force_hold.choose_hold(asked, typical_plant(asked[0]))
    return _with(choice, records), (_told(choice),)


def held_otherwise(prepared: Prepared, fitted: FitResult) -> Prepared | None:
    """The records with another hold of the force, or an earlier force, where a diagnosed model makes up for that.

    The hold was decided with a plant and dry friction. A law that these lack may hide it, and then a delay of half a
    sample makes up for a wrong answer: the model without its delay decides again. A force that acts before its stamps,
    by up to half a sample, is a matter of the recording.

    Args:
        prepared: the records as they were diagnosed.
        fitted: what explains them.

    Returns:
        None where the hold is known, where a lead was found already, and where neither is so.
    """
    if not prepared.asks_hold:
        return None
    return _decided_again(prepared, fitted.model) or _earlier(prepared, fitted)


def _decided_again(prepared: Prepared, model: Model) -> Prepared | None:
    asked = tuple(filter(force_hold.is_open, prepared.unheld))
    if not asked or not force_hold.stands_for_a_hold(model, prepared.records):
        return None
    prompt = replace(model, effects=tuple(effect for effect in model.effects if effect.structure != DELAY))
    choice = force_hold.compared(asked, (prompt,))
    records = _with(choice, prepared.unheld)
    same = all(_same_force(one, now) for one, now in zip(records, prepared.records, strict=True))
    return None if same else _prepared_again(prepared, records, _told(choice))


def _earlier(prepared: Prepared, fitted: FitResult) -> Prepared | None:
    pairs = zip(prepared.unheld, prepared.records, strict=True)
    held = [replace(now, hold_known=one.hold_known) for one, now in pairs]  # as decided, with stamps that may be late
    lead = force_lead.found(fitted, held)
    if lead == 0.0:
        return None
    records = tuple(force_lead.shifted(one, lead) for one in held)
    said = Finding("warning", "force_lead", force_lead.sentence(lead, prepared.records))
    return _prepared_again(prepared, records, said)


def _prepared_again(prepared: Prepared, records: tuple[Record, ...], finding: Finding) -> Prepared:
    """The same with other records, and with a finding in place of the one of its kind."""
    before = next((one for one in prepared.findings if one.code == finding.code), None)
    warnings = [one for one in prepared.warnings if before is None or one != before.sentence]
    warnings += [finding.sentence] if finding.severity == "warning" else []
    findings = [one for one in prepared.findings if one is not before]
    return replace(prepared, records=records, findings=(*findings, finding), warnings=tuple(warnings))


def _same_force(one: Record, other: Record) -> bool:
    """Whether the force of two records is the same at all times."""
    same = np.array_equal(one.force, other.force) and np.array_equal(one.force_time, other.force_time)
    return same and one.hold == other.hold


def _with(choice: force_hold.HoldChoice, records: tuple[Record, ...]) -> tuple[Record, ...]:
    """The records with the chosen hold, where theirs was open."""
    held = (force_hold.with_hold(record, choice.hold) if force_hold.is_open(record) else record for record in records)
    return tuple(held)


def _told(choice: force_hold.HoldChoice) -> Finding:
    severity: Severity = "info" if choice.hold == "zero" else "warning"
    return Finding(severity, "force_hold", choice.sentence)


@dataclass(frozen=True)
class _Understood:
    """A record, its features, and how the force of its first line was taken where that was in doubt."""

    record: Record
    features: Features
    remark: str = ""


def _understood(record: Record) -> _Understood:
    """A force in the first line that had acted before it is no step."""
    if not quality.begins_pushed(record):
        return _Understood(record, extract(record))
    acts = f"The force of {record.force[0]:.4g} {record.force_unit} in the first line"
    before = quality.since_before(record)
    if quality.rests_under_force(record):
        said = f"{acts} is assumed to have acted before the record began, because the cart is at rest under it."
        return _Understood(before, extract(before), said)
    features = extract(record)
    if _is_turned(features.standard_form) and not np.ptp(before.force):
        said = (
            f"{acts} never changes and the cart moves against it. The record is treated as a release under this "
            "force, a "
            "free decay; if the force stepped there and the encoder is inverted, use a negative --position-scale."
        )
        return _Understood(before, extract(before), said)
    return _Understood(record, features)


def pushes(record: Record) -> bool:
    """Whether the force changes. One that has acted unchanged since before the record is part of the unknown zero."""
    before = record.force_at([np.nextafter(record.time[0], -np.inf)])
    return bool(np.ptp(np.concatenate((before, record.force_at(record.time)))))


def _turned(form: StandardForm | None, understood: Sequence[_Understood]) -> bool:
    """Whether a positive force moves the encoder downwards: as the responses to steps say; where none does, as fits
    say, which a regression may ask for.
    """
    if form is not None and form.static_gain is not None:
        return _is_turned(form) and (not _doubtful(understood) or turned_force.leaves_less(*_both(understood)))
    asked = opposite_signs.turned([one.record for one in _driven(understood)])
    return turned_force.leaves_far_less(*_both(understood), asked=asked)


def _driven(understood: Sequence[_Understood]) -> list[_Understood]:
    return [one for one in understood if np.ptp(one.record.force) > 0.0]


def _both(understood: Sequence[_Understood]) -> tuple[list[Record], list[Record]]:
    """The driven records with the force as it is, and turned."""
    as_it_is, turned = ([_usable(one, turned) for one in _driven(understood)] for turned in (False, True))
    return as_it_is, turned


def _is_turned(form: StandardForm | None) -> bool:
    """Whether a positive force moves the encoder downwards."""
    return form is not None and form.static_gain is not None and form.static_gain.value < 0.0


def _doubtful(understood: Sequence[_Understood]) -> bool:
    """Whether the responses that were read are few of the steps of the force: one of many in a random binary force,
    from a short standstill, may have the wrong sign.
    """
    steps = sum(int(np.count_nonzero(np.diff(one.record.force))) for one in understood)
    return steps > 2 * sum(len(one.features.responses) for one in _driven(understood))


def _refuse_units(records: Sequence[Record]) -> None:
    if not records:
        raise UsageError("no records to identify; expected at least one")
    units = sorted({(record.force_unit, record.position_unit) for record in records})
    if len(units) > 1:
        listed = " and ".join(f"{force}, {position}" for force, position in units)
        raise UsageError(f"records in {listed}; expected one pair of units: give scales, or identify them one by one")


def _examined(records: Sequence[Record]) -> tuple[tuple[Examined, ...], tuple[str, ...]]:
    """The records in which anything happens, and a sentence for each that is left out; all, if nothing does in any."""
    examined = tuple(quality.examine(record) for record in records)
    moving = tuple(one for one in examined if not one.idle)
    if not moving:
        return examined, ()
    idle = (one.given.name for one in examined if one.idle)
    return moving, tuple(f"{name} is left out: its force never changes and its cart never moves." for name in idle)


def _refuse(findings: Sequence[Finding]) -> None:
    for finding in findings:
        if finding.severity == "error":
            raise DataError(finding.sentence)


def _usable(understood: _Understood, turned: bool) -> Record:
    """The record that models are fitted to: from the release on, and the force turned where K is negative."""
    record, features = understood.record, understood.features
    if features.freed is not None:
        record = record.cut(features.freed, float(record.time[-1]))
        record = quality.since_before(record) if quality.begins_pushed(record) else record
    return replace(record, force=-record.force) if turned else record


def _rest_before(understood: _Understood, used: Record, form: StandardForm | None) -> Record | None:
    """Rest that lies before the part of a record that is used; a period before the first motion may be a hand's.

    Where the cart stands far from where it comes to rest in the end, a hand holds it: that is no rest.
    """
    record, responses = understood.record, understood.features.responses
    if used.time[0] == record.time[0] or form is None or not responses:
        return None
    rest = quality.rest_before(record, 2.0 * math.pi / form.natural_frequency.value)
    if rest is None:
        return None
    end = responses[0].steady_state.value
    away = abs(float(np.median(rest.position)) - end)
    rest = replace(rest, origin=used.origin)
    return rest if away <= _HELD * float(np.max(np.abs(used.position - end))) else None


def _warnings(
    records: tuple[Record, ...], findings: Sequence[Finding], features: Sequence[Features], turned: bool
) -> tuple[str, ...]:
    """What a reader must know about the data before using the numbers."""
    said = [note for record in records for note in record.notes]
    said += [finding.sentence for finding in findings if finding.severity == "warning"]
    said += [remark for found in features for remark in found.remarks]
    if turned:
        said.append(
            "A positive force moves the encoder downwards: K is negative, and m, b and k are for the inverted force."
        )
    return tuple(dict.fromkeys(said))
