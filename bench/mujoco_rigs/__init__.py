"""Rigs of a second author: random, and simulated by MuJoCo.

Nothing here imports ``msd_ident`` or ``msd_sim``: the diagnosis and these rigs share no line and no law's exact form.
"""
