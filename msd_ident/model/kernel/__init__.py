"""The compiled solver. Importing its modules imports numba: only ``model.simulate`` does, when first needed."""
