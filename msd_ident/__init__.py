"""Turn a force input and an encoder signal into a model a lab can trust."""

import os

# On matrices of ten by ten the threads of BLAS gain nothing, and spin beside those that fit: a diagnosis takes a fifth
# longer with them. A setting of the user's own stands, and so does numpy's where it was imported before.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
