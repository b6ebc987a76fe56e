"""A UFL energy becomes forms in local frames."""
