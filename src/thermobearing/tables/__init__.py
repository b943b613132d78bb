"""Tables of numbers read from files: laboratory tests, motions, weather, spectra."""
