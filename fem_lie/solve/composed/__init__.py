"""Schemes of higher order that are made of steps of another one."""
