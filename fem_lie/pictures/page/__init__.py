"""Interactive HTML pages: an animation of a scene in one file, without a network."""
