"""Synthetic papers: problems, motions and printed tables by a route that the judge has no part in.

Nothing here imports the package. `motions` fits and measures curves with scipy, `drafts` draws a
problem and true answers, `claims` states what is true of them, `printing` turns numbers into
printed digits, `planted` alters what is printed by one fault of known size.
"""
