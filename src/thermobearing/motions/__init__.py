"""Ground motions: reading, processing, spectra, and spectrum-compatible motions."""
