"""Rows of a regression: the truth balances them without a derivative of the readings, and rest gives none."""

from __future__ import annotations

import numpy as np
from fitrigs import measured

from msd_ident.data.record import from_samples
from msd_ident.estimate.weak_form import WIDTHS, Means, uniform
from msd_ident.model import Plant

PLANT = Plant(1.0, 4.0, 700.0)


def test_the_true_parameters_balance_the_force_in_every_row() -> None:
    record = measured(PLANT, {"name": "paper"}, rate=1000.0, encoder={"counts_per_metre": 0.0})
    for half in WIDTHS[:3]:
        means = Means(uniform(record, 0.0), half)
        rows = means.rows((), dict(zip(PLANT.names, PLANT.values.tolist(), strict=True)))
        balance = sum(PLANT[name] * rows.columns[name] for name in PLANT.names)
        # A force that steps within a sample counts half on either side of it.
        assert np.max(np.abs(balance - rows.force)) < 0.01 * np.max(np.abs(rows.force))
        assert np.ptp(rows.constant) == 0.0


def test_where_the_cart_rests_there_are_no_rows() -> None:
    time = np.arange(2000) * 1e-3
    moving = np.where(time < 1.0, 0.0, 0.01 * np.sin(20.0 * (time - 1.0)))
    means = Means(uniform(from_samples(time, np.zeros(time.size), moving), 0.0), WIDTHS[1])
    assert 0 < means.force.size < 0.6 * time.size / (WIDTHS[1] // 2)
