"""Measure speed, accuracy and memory against targets: `python -m benchmarks [--json FILE]`.

Benches are not tests: the exit status is always 0, and the table says what was not met.
"""
