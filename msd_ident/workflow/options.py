"""What the user may decide about an identification or a diagnosis."""

from __future__ import annotations

from dataclasses import dataclass

from msd_ident.errors import UsageError
from msd_ident.estimate.objective import Loss
from msd_ident.residuals.unexplained import TOLERANCE
from msd_ident.workflow.known_parameters import Known

MODELS = ("auto", "spring", "no_spring")
LOSSES = ("linear", "soft_l1")


@dataclass(frozen=True)
class Options:
    """What the user may decide about an identification.

    Attributes:
        model: ``spring`` or ``no_spring`` (a plain axis); ``auto`` lets the data say.
        loss: ``linear``, or ``soft_l1`` for data with outliers.
        known: parameters known beforehand, which the fit keeps; their uncertainty goes into all intervals.
        tolerance: part of the motion's rms [%] that a diagnosis may leave unexplained and still be called complete.
        calibrate: correct a diagnosis by simulated copies of the records, whatever it costs; else where it is cheap.

    Raises:
        UsageError: another word, or a tolerance that is no part.
    """

    model: str = "auto"
    loss: Loss = "linear"
    known: tuple[Known, ...] = ()
    tolerance: float = TOLERANCE
    calibrate: bool = False

    def __post_init__(self) -> None:
        for what, found, known in (("model", self.model, MODELS), ("loss", self.loss, LOSSES)):
            if found not in known:
                raise UsageError(f"{what} is {found!r}; expected one of {', '.join(known)}")
        if not 0.0 <= self.tolerance < 100.0:
            raise UsageError(f"tolerance is {self.tolerance} % of the motion; expected 0 to less than 100")
