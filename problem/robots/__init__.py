"""One file per robot: its Denavit–Hartenberg table and where it stands."""
