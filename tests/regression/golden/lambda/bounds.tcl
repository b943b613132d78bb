# shen-hdr-bridge: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# Each bound is a bilinear loop that matches peak force and energy of its cycle; its Q_d is therefore larger than that of the real loop, which the factors use.
# K_1 follows from K_2 by the usual ratio of its kind. Of a lead rubber bearing the report and links.txt of a bridge state a larger K_1, the initial stiffness of its model.
# The lower and the upper bound are of tested rubber. As a rule, that of virgin rubber governs forces and the lower one displacements.
# lower bound: heated cycle at 40 degC, 100% strain; Q_d 86.5632 kN, K_1 6.11172, K_2 1.16123 kN/mm
uniaxialMaterial Steel01 1 106.86818863738057 6.11171692877007 0.18999999999999997
# upper bound: first cycle at -20 degC, 100% strain; Q_d 181.046 kN, K_1 19.4613, K_2 3.69764 kN/mm
uniaxialMaterial Steel01 2 223.51306599328254 19.461261188965207 0.18999999999999997
# virgin bound: first cycle at -20 degC, 100% strain; Q_d 259.015 kN, K_1 21.7994, K_2 4.1419 kN/mm
uniaxialMaterial Steel01 3 319.7721258911563 21.799448319684153 0.18999999999999997
