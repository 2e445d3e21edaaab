"""One robot over days: change points of its parameters, and an alarm with a known false-alarm rate.

In: estimates with time stamps, from a table or a history file. Out: a ``Watch`` with changes, alarms and a sentence.
Begin with ``watching``, then ``changes`` (change points) and ``alarm``.
"""
