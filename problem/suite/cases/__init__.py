"""One case file per instance of the suite."""
