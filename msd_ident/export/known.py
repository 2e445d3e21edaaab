"""What a result did not fit: parameters that were known or assumed, which a further fit on its record keeps."""

from __future__ import annotations

import json

from msd_ident.errors import DataError, UsageError
from msd_ident.model import Model
from msd_ident.workflow.known_parameters import Known
from msd_ident.workflow.saved_model import SavedModel


def known(saved: SavedModel) -> tuple[Known, ...]:
    """The parameters that were known when the result was made, with their standard deviations.

    Raises:
        DataError: the result does not tell them as ``msd identify`` does.
    """
    told = json.loads(saved.text or "{}").get("known", ())
    try:
        return tuple(Known(str(one["name"]), float(one["value"]), float(one["std"])) for one in told)
    except (KeyError, TypeError, ValueError, UsageError) as error:
        raise DataError(
            f"the known parameters of the result cannot be read ({error}); expected name, value and std of each: renew "
            "it with msd identify PATH --json FILE"
        ) from None


def kept(saved: SavedModel, model: Model) -> dict[str, float]:
    """Name → value of what a fit of a model keeps: what was known or assumed, and a spring that is not there.

    Args:
        saved: the result.
        model: to be fitted; what it lacks is left out.

    Raises:
        DataError: as ``known``.
    """
    fixed = {name: model[name] for name, own in saved.parameters.items() if own.std == 0.0 and name in model.names}
    fixed |= {one.name: one.value for one in known(saved) if one.name in model.names}
    return fixed | ({"stiffness": 0.0} if model.stiffness == 0.0 else {})
