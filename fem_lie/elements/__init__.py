"""Element families: one file each, with its strain measures and its energy."""
