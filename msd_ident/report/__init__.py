"""What a person sees: terminal tables, pages and figures. It arranges results and computes none.

In: results (``Identification``, ``Diagnosis``, ``Validation``, ``Export``). Out: tables, HTML, Markdown, PNG and SVG.
Begin with ``page`` and ``sections``, then ``tables`` (terminal), ``plots`` and ``figures``.
"""
