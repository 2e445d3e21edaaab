"""Which parameters do several robots, joints or days share, which ones differ, and with what probability?

In: estimates with covariances, grouped, from a table of ``batching``. Out: a ``Comparison`` with its sentence.
Begin with ``comparing``, then ``hypotheses`` (what may be shared) and ``rows`` (from table rows to estimates).
"""
