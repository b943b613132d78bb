"""A file with a law of one's own, as tests of laws load it."""

ARRHENIUS = '''
import math

import thermobearing as tb


def arrhenius(temperature, elastic=300.0, hysteretic=900.0):
    """The parameters are activation energies."""
    inverse = 1.0 / (temperature + 273.15) - 1.0 / 296.15
    return math.exp(elastic * inverse), math.exp(hysteretic * inverse)


tb.laws.register("arrhenius", temperature=arrhenius)
'''
