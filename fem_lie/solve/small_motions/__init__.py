"""Analyses by the linearised equations of motion: frequency response, whirl of rotors, flutter."""
