"""Records of measurements, and their properties without a model.

In: arrays of force and position with stamps. Out: a checked, frozen ``Record``, its motion, noise, force steps, data
sheet and findings. Begin with ``record``, then ``motion``, ``onsets`` and the checks in ``quality``.
"""
