"""Speed, accuracy and memory, each beside its target: `python -m benchmarks [--json FILE]`.

Benches are not tests: the exit status is always 0, and the table says what was not met.
"""
