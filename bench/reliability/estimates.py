"""Whether estimates from bad data are right, reported as doubtful, or wrong without a warning."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

import numpy as np

from bench.reliability.datafaults import Fault, clean
from msd_ident.errors import MsdError
from msd_ident.quantity import Quantity
from msd_ident.workflow import pipeline
from msd_ident.workflow.identification import Identification

#: Deviation from the clean result up to which an estimate is right.
TOLERANCE: Mapping[str, float] = MappingProxyType({"mass": 0.01, "stiffness": 0.01, "friction_coefficient": 0.05})
#: Words of the warnings that speak of the numbers themselves.
DOUBTS = ("the model lacks something", "Something pushed the cart", "did not converge")


@dataclass(frozen=True)
class Verdict:
    """Result from one record with a fault.

    Attributes:
        worst: largest deviation from the clean result, in parts of what is allowed.
        doubted: whether every number that is wrong is said to be in doubt, or none is given.
        said: the warnings.
    """

    worst: float
    doubted: bool
    said: str

    @property
    def outcome(self) -> str:
        """``right``, ``doubted`` or ``fooled``."""
        return "right" if self.worst <= 1.0 else "doubted" if self.doubted else "fooled"


def judge(fault: Fault, seed: int) -> Verdict:
    """Spoil the clean record with this seed, identify, compare."""
    try:
        found = pipeline.identify([fault.spoil(clean(), np.random.default_rng(seed))])
    except MsdError as error:
        return Verdict(np.inf, True, str(error))
    truth, numbers = _clean_numbers(), _numbers(found)
    parts = {
        name: abs(numbers[name].value / truth[name].value - 1.0) / allowed if name in numbers else np.inf
        for name, allowed in TOLERANCE.items()
    }
    said = " / ".join((*found.warnings, *found.open))
    in_doubt = any(words in said for words in DOUBTS)
    wrong = [name for name, part in parts.items() if part > 1.0]
    return Verdict(max(parts.values()), in_doubt or all(not _is_given(numbers, name) for name in wrong), said)


@cache
def _clean_numbers() -> Mapping[str, Quantity]:
    return _numbers(pipeline.identify([clean()]))


def _numbers(found: Identification) -> Mapping[str, Quantity]:
    return found.refined.parameters


def _is_given(numbers: Mapping[str, Quantity], name: str) -> bool:
    return name in numbers and numbers[name].known
