"""Cells whose nodes have rows with increments that add: their forces over a step."""
