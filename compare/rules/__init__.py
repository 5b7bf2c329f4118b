"""The audit's rules, one module per kind of evidence; each yields findings about a case."""
