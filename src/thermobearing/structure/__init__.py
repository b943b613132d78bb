"""Structures on bearings: built from bodies and connections, moved by the ground."""
