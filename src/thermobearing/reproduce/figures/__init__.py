"""The computed figures of the source: a module each, with `CAPTION` and `draw(runs)`."""
