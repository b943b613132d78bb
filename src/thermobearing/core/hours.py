"""A bearing at rest hour after hour, where an hour leads to is linear in what was before."""

from thermobearing.core.compile import compiled
from thermobearing.core.records import Floats, Ints


@compiled
def hours_at_rest(
    kept: Floats,
    early: Floats,
    late: Floats,
    air: Floats,
    places: Ints,
    now: Floats,
    after: Floats,
    found: Floats,
) -> None:
    """Temperatures at some hours: after = kept @ now + early * air + late * air an hour later.

    Parameters
    ----------
    kept : [n, n], transposed: row j is what temperature j gives to all an hour later.
    early, late : [n] what the air at the two ends of the hour gives.
    air : at full hours [degC].
    places : hours that are wanted, increasing.
    now : [n] temperatures at hour 0 [degC]; overwritten, as `after`, which is scratch.
    found : [wanted, n] where they go.
    """
    here = 0
    for row in range(len(places)):
        while here < places[row]:
            for i in range(len(now)):
                after[i] = early[i] * air[here] + late[i] * air[here + 1]
            for j in range(len(now)):
                part = now[j]
                for i in range(len(now)):
                    after[i] += kept[j, i] * part
            for i in range(len(now)):
                now[i] = after[i]
            here += 1
        for i in range(len(now)):
            found[row, i] = now[i]
