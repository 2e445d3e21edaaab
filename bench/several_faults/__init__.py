"""Rigs of a third author, with three to five faults at once; Runge-Kutta steps of its own, 30 in each sample.

It imports neither ``msd_ident`` nor ``msd_sim``. Begin with ``rig``, then ``simulate``.
"""
