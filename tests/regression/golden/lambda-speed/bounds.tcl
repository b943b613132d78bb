# lrb-example: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# Each bound is a bilinear loop that matches peak force and energy of its cycle; its Q_d is therefore larger than that of the real loop, which the factors use.
# K_1 follows from K_2 by the usual ratio of its kind. Of a lead rubber bearing the report and links.txt of a bridge state a larger K_1, the initial stiffness of its model.
# lower bound: heated cycle at 20 degC, 100% strain; Q_d 147.089 kN, K_1 6.96365, K_2 0.857065 kN/mm
uniaxialMaterial Steel01 1 167.73273393408772 6.9636494020218525 0.12307692307692308
# upper bound: first cycle at -20 degC, 100% strain; Q_d 221.404 kN, K_1 7.99942, K_2 0.984545 kN/mm
uniaxialMaterial Steel01 2 252.47878806265112 7.99942425944585 0.12307692307692308
