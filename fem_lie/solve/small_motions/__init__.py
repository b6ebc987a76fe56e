"""Analyses by the linearised equations of motion: frequency response."""
