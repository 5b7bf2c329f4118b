"""These tests are about a kind of proof of its own, on problems small enough to be quick."""

from support.proof_runs import own_kinds as own_kinds
