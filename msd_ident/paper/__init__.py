"""The paper's method: its tables, its models, and its refinement of dry friction.

In: the six numbers of the paper's Table 1, or a record. Out: Tables 2 and 3, and m, b, k with Fc after the paper.
Begin with ``tables``, then ``method`` and ``refinement``.
"""
