"""Hourly weather: files, synthetic series of a climate, and hours of earthquakes."""
