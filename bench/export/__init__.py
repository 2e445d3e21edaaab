"""Compares exported models with msd_ident in their target, and checks which errors of a wrong simulation are named."""
