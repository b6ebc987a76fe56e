"""Ropes through rings: a place of a rope that slides along it stays where a ring is."""
