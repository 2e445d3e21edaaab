"""The compiled solver. Importing its modules imports numba, so ``model.simulator`` does it at the first simulation."""
