"""Reduced bodies for scenes in time: made, kept in files, and expanded to full fields."""
