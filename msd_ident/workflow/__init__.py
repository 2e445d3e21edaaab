"""From records to results: the path that command line, nodes and Python share.

In: one record or several of one rig. Out: an ``Identification``, a ``Diagnosis``, a ``Validation`` of a saved model.
Begin with ``pipeline``, then ``preparation``.
"""
