"""Sentences on causes that no data of this kind can tell apart."""

from __future__ import annotations

from msd_ident.model import Model


def sentences(model: Model, forced: bool, gain_known: bool) -> tuple[str, ...]:
    """Sentences on what no data of this kind can tell apart in a model.

    Args:
        model: its effects give their own sentences.
        forced: whether any force acts in the data.
        gain_known: whether the force is known in newtons.
    """
    said = [effect.same_as_beside(model) for effect in model.effects] + [e.same_as(model) for e in model.effects]
    said = [sentence for sentence in said if sentence]
    if not forced:
        said.append(
            "No force acts in this data, so mass, damping, stiffness and friction are known only as ratios; the "
            "numbers are those of a mass of 1 kg, of a joint 1 kg·m². Multiply them by yours."
        )
    elif not gain_known:
        said.append("The force's gain is unknown, so mass, damping, stiffness and friction share one unknown factor.")
    return tuple(said)
