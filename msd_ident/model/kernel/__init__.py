"""The compiled solver. Importing its modules imports numba: only ``model.simulator`` does, when first needed."""
