"""One case file per published paper."""
