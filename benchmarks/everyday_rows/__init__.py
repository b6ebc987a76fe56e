"""Rows of the table of everyday speed, a file for each subject."""
