"""Draws catalogues, frames and arrays; knows no result."""
