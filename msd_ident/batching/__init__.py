"""Diagnoses of many records: found below folders or in object stores, run on many processes, collected in one table.

In: paths, and a ``Job`` that says how each record is read and diagnosed. Out: a table with one row per record.
Begin with ``batch``, then ``work`` (what a worker does with one record) and ``row`` (the columns).
"""
