"""Ground motions: reading, preparing, spectra, and motions made to fit a spectrum."""
