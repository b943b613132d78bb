# lrb-example: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# Each bound is a bilinear loop with the stated K_2/K_1, and with the peak force and the area of its cycle. Its force at zero displacement, Q_d, therefore differs from that of the cycle, which the factors use.
# lower bound: heated cycle at 20 degC, 100% strain; Q_d 147.089 kN, K_1 6.96365, K_2 0.857065 kN/mm
uniaxialMaterial Steel01 1 167.73273393408755 6.96364940202187 0.12307692307692308
# upper bound: first cycle at -20 degC, 100% strain; Q_d 221.404 kN, K_1 7.99942, K_2 0.984545 kN/mm
uniaxialMaterial Steel01 2 252.478788062651 7.999424259445847 0.12307692307692308
