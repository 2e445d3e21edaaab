"""What a fitted model leaves: tests of its residuals, the missing force, and what that force depends on.

In: records, and the residuals of a fitted model. Out: whether they are noise (``adequacy``), the missing force with its
band (``disturbance``), and characteristic curves without a law (``nonparametric``). Begin with ``noise_model``.
"""
