"""Residual of a fitted model: its tests, the missing force, and the signals that this force depends on.

In: records, and the residuals of a fitted model. Out: whether they are noise (``adequacy``), the missing force with its
band (``disturbance``), and characteristic curves without a law (``nonparametric``). Begin with ``noise_model``.
"""
