"""Scragging and Mullins softening: virgin rubber is stiffer than rubber that has worked.

The stiffness terms of a layer are multiplied by

    elastic      1 + a v
    hysteretic   (1 + a v)^2 (1 + b e^{-D/(gamma t_r)})

D is the largest |d| so far, v in [0, 1] the virgin share of the layer:

    dv = -v |dd| / (c D) + (1 - v) dD / (l D)

so v falls with the travel relative to the largest strain (Mullins) and comes back where the
rubber is strained further than ever before. After Grant, Fenves & Whittaker (2004), who have
one damage variable for the largest excursion (scragging) and one for the accumulated travel
(Mullins); this form is ours. Recovery in rests is ignored. D and v are those of the start of a
step: force and tangent of the step are what they are for constant stiffness.

The d in both is the mean displacement of the layers, x/N, not that of one layer. Scragging can
take more force from a layer than a larger displacement adds (at -20 degC, with the assumed b). If
each layer had a separate D, the one ahead by a rounding error would then soften first and go
further ahead in every step: the smaller the step, the more peaks would depend on the processor.
"""

import math

from thermobearing.core.compiled.kernel import compiled_apart
from thermobearing.core.lanes.choose import any_lane, select
from thermobearing.core.records import Rows
from thermobearing.core.types import Layer, LayerWork, Rubber
from thermobearing.core.vector import Vector, minus, norm


@compiled_apart
def stiffen(rubber: Rubber, layers: Rows[Layer], work: LayerWork) -> None:
    """Multiply both stiffness terms of every layer by what is left of its virgin stiffness."""
    for j in range(len(work.trial)):
        factor = 1.0 + rubber.mullins_amplitude * layers[j].virgin
        unstrained = math.exp(-layers[j].farthest / rubber.scragging_displacement)
        work.elastic[j] *= factor
        work.hysteretic[j] *= factor * factor * (1.0 + rubber.scragging_amplitude * unstrained)


@compiled_apart
def wear(
    rubber: Rubber, old: Rows[Layer], new: Rows[Layer], mean_before: Vector, mean: Vector
) -> None:
    """Largest displacement and virgin share after a step that moves the layers to `mean`."""
    size, moved = norm(mean), norm(minus(mean, mean_before))
    for j in range(len(old)):
        before = old[j].farthest
        largest = max(before, size)
        v = old[j].virgin
        strained = largest > 0.0
        if any_lane(strained):
            worn = v * math.exp(-(moved / largest) / rubber.mullins_decay)
            growth = (largest - before) / largest
            worn = 1.0 - (1.0 - worn) * math.exp(-growth / rubber.mullins_renewal)
            v = select(strained, worn, v)
        new[j].farthest = largest
        new[j].virgin = v
