"""Which causes act: sets of effects are fitted, ranked by evidence and calibrated on the record itself.

In: an ``Experiment`` and its base model. Out: ranked ``Hypothesis`` objects with probabilities and ties.
Begin with ``experiment`` and ``hypothesis``, then ``structure_search``, ``evidence`` and ``ranking``.
"""
