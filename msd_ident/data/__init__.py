"""Records of measurements, and their properties without a model.

In: arrays of force and position with stamps. Out: a checked, frozen ``Record``, its motion, noise, data sheet and
findings. Begin with ``record``, then ``motion`` and the checks in ``quality``.
"""
