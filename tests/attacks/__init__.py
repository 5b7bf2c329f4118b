"""Attacks: seeded generators and brute force against everything that trajgap reads and answers."""
