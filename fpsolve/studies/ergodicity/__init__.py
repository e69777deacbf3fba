"""Averages along one path, and how fast they settle."""
