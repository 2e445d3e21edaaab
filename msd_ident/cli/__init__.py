"""The ``msd`` command, one file per subcommand.

In: the words of a command line. Out: tables on the terminal, JSON, pages and files, and an exit code.
Begin with ``main``, then ``options`` and ``groups`` (shared options) and ``solving`` (paths in, results out).
"""
