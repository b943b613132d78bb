"""Inside the matching of spectra: what each band of frequencies adds to a response."""

import numpy as np
from numpy.testing import assert_allclose

from tests import tolerances as tol
from thermobearing.motions.library import load_motion
from thermobearing.motions.matching import COARSE, _Amplitudes
from thermobearing.motions.process import padded, with_quiet_end
from thermobearing.motions.spectrum import DAMPING, response_spectrum
from thermobearing.motions.synthesis import ROOM


def shaken_amplitudes() -> _Amplitudes:
    motion = padded(load_motion("jra-ii-i-1"), before=ROOM, after=10.0 * ROOM)
    amplitudes = _Amplitudes(motion.acceleration, motion.dt, COARSE)
    stream = np.random.default_rng(1)
    amplitudes.logarithm = 0.3 * stream.standard_normal(COARSE.bands)
    return amplitudes


def test_sensitivity_is_the_response_to_each_band() -> None:
    """The same forwards: the history of each band with its ends in order, and its response."""
    amplitudes = shaken_amplitudes()
    which = np.arange(0, COARSE.periods, 7)
    times = np.linspace(5.0, 40.0, len(which)) + 0.0037  # between the samples too
    bands = amplitudes.bands.toarray().T * amplitudes.multiplied()
    tapered = np.fft.irfft(bands, amplitudes.size)[:, : amplitudes.length] * amplitudes.taper
    parts = np.fft.rfft(with_quiet_end(tapered, amplitudes.dt), amplitudes.size)
    parts[:, 1:-1] *= 2.0  # of each pair of frequencies, one is kept
    w = 2.0 * np.pi * amplitudes.frequency
    wn = 2.0 * np.pi / amplitudes.periods[which, np.newaxis]
    spring = wn**2 + 2.0j * DAMPING * wn * w
    waves = spring / (spring - w**2) * np.exp(1j * w * times[:, np.newaxis])
    forwards = np.real(waves @ parts.T) / amplitudes.size
    backwards = amplitudes.sensitivity(which, times)
    assert_allclose(backwards, forwards, rtol=0.0, atol=tol.ADJOINT * np.abs(forwards).max())


def test_bands_add_up_to_the_peak_of_the_response() -> None:
    """Waves between the samples there, straight lines in the spectrum: not quite the same."""
    amplitudes = shaken_amplitudes()
    spectrum = response_spectrum(amplitudes.motion(), amplitudes.periods, DAMPING)
    first = np.where(spectrum.peaks[0] > spectrum.peaks[1], 0, 1)
    times = spectrum.peak_times[first, np.arange(COARSE.periods)]
    added = amplitudes.sensitivity(np.arange(COARSE.periods), times).sum(axis=1)
    long = amplitudes.periods > 0.5
    assert_allclose(np.abs(added[long]), spectrum.acceleration[long], rtol=tol.STRAIGHT_LINES)
