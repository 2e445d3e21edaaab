"""The paper's method from its Table 1 alone, and what its model cannot reproduce of these six numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from msd_ident.errors import UsageError
from msd_ident.model import Simulator
from msd_ident.paper.models import (
    LENGTHS,
    TIMES,
    Closest,
    Response,
    nearest_coulomb,
    respond,
    single_causes,
    step_record,
    undecidable,
)
from msd_ident.paper.tables import Derived, Printed, Table1, derive, losses, printed_refined

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Paper:
    """Result of ``msd paper``.

    Attributes:
        table, printed: what the paper gives.
        derived: Tables 2 and 3 by eqs. 3 to 13.
        printed_response: step response of the refined model as printed.
        coulomb: the viscous + Coulomb model nearest to all numbers of Table 1, by least squares.
        coulomb_even: the one whose largest difference of a peak or the rest value is least, at any times.
        causes: single causes beside m, b, k, nearest first.
        undecidable: causes with more parameters than Table 1 has numbers.
    """

    table: Table1
    printed: Printed
    derived: Derived
    printed_response: Response
    coulomb: Closest
    coulomb_even: Closest
    causes: tuple[Closest, ...]
    undecidable: tuple[str, ...]

    @property
    def sentences(self) -> tuple[str, ...]:
        """What follows, for people."""
        lost = losses(self.table)
        able = [cause.cause for cause in self.causes if cause.reproduces]
        return (
            f"The printed refined model peaks at {100 * self.printed_response.first_peak:.3f} cm, where the data has "
            f"{100 * self.table.first_peak:.3f} cm.",
            f"No viscous + Coulomb model reproduces peaks and rest value: with m, b, k and Fc all free the nearest one "
            f"is {100 * self.coulomb.distance:.3f} cm off, and none is less than "
            f"{100 * self.coulomb_even.distance:.3f} cm off in all three.",
            f"The first half-swing loses {100 * lost.first:.0f} % of its amplitude, later ones "
            f"{100 * lost.later:.1f} % each: loss that grows with "
            "amplitude, the opposite of what Coulomb friction does.",
            f"Alone beside m, b and k these reproduce the table: {', '.join(able) or 'none'}. "
            "One step cannot say which.",
            f"More parameters than the table has numbers, so that it cannot speak about them: "
            f"{', '.join(self.undecidable) or 'none'}.",
        )

    def to_json_dict(self) -> dict[str, Any]:
        """The contract ``msd.paper/1``. Table 1 has no intervals, so std is null."""
        derived, lost = self.derived, losses(self.table)
        form = {"natural_frequency": "rad/s", "damping_ratio": "1", "static_gain": "m/N", "force": "N"}
        physical = {"mass": "kg", "damping": "N·s/m", "stiffness": "N/m"}
        inconsistency: dict[str, Any] = {
            f"{name}_{unit}": {
                "data": factor * getattr(self.table, name),
                "best_coulomb_model": factor * getattr(self.coulomb.response, name),
                "most_even_coulomb_model": factor * getattr(self.coulomb_even.response, name),
                "printed_refined_model": factor * getattr(self.printed_response, name),
            }
            for names, unit, factor in ((LENGTHS, "cm", 100.0), (TIMES, "s", 1.0))
            for name in names
        }
        inconsistency["largest_distance_cm"] = 100.0 * self.coulomb.distance
        inconsistency["least_largest_distance_cm"] = 100.0 * self.coulomb_even.distance
        inconsistency["amplitude_lost_percent"] = {"first_half_swing": 100.0 * lost.first, "later": 100.0 * lost.later}
        return {
            "schema": "msd.paper/1",
            "standard_form": {name: _quantity(getattr(derived, name), unit) for name, unit in form.items()},
            "original": {name: _quantity(getattr(derived, name), unit) for name, unit in physical.items()},
            "inconsistency": inconsistency,
            "single_causes": [
                {
                    "name": c.cause,
                    "distance_cm": 100.0 * c.distance,
                    "distance_s": c.lateness,
                    "reproduces": c.reproduces,
                }
                for c in self.causes
            ],
            "undecidable": list(self.undecidable),
            "sentences": list(self.sentences),
        }


def _quantity(value: float, unit: str) -> dict[str, Any]:
    return {"value": value, "std": None, "unit": unit}


def study(table: Table1 = Table1(), progress: Progress = lambda stage, fraction: None) -> Paper:  # noqa: B008 - frozen
    """The paper's method from its Table 1 alone: Tables 2 and 3, and what no viscous + Coulomb model reproduces.

    Args:
        table: the six numbers of Table 1.
        progress: called with the stage and the fraction done (0 to 1).

    Raises:
        UsageError: a table whose numbers no oscillation has (peaks that do not fall, times that do not rise).
    """
    derived = derive(table)
    refined = printed_refined(Printed())
    printed_response = respond(refined, Simulator(refined, step_record(table)))
    progress("the nearest viscous + Coulomb model", 0.1)
    coulomb = nearest_coulomb(table)
    if printed_response is None or coulomb is None:
        raise UsageError("no model with two peaks comes near Table 1; expected the numbers of an oscillation")
    progress("every single cause", 0.5)
    near, even = coulomb
    return Paper(table, Printed(), derived, printed_response, near, even, single_causes(table), undecidable())
