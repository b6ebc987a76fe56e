"""Pages of the site that are made of scripts, records and docstrings."""
