"""Bearings as elements of OpenSees models: wire format, server, result, report."""
