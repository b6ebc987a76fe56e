"""Contact pairs: for each two kinds of surfaces a class with its checks, gaps and forces."""
