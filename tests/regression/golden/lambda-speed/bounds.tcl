# lrb-example: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# Each bound has the peak force and the loop area of its cycle, with a chosen K_2/K_1; its Q_d is therefore not that of the factors, which is half the difference of the forces at zero displacement.
# lower bound: heated cycle at 20 degC, 100% strain; Q_d 147.089 kN, K_1 6.96365, K_2 0.857065 kN/mm
uniaxialMaterial Steel01 1 167.73273393408616 6.963649402021858 0.12307692307692308
# upper bound: first cycle at -20 degC, 100% strain; Q_d 221.404 kN, K_1 7.99942, K_2 0.984545 kN/mm
uniaxialMaterial Steel01 2 252.4787880626509 7.999424259445865 0.12307692307692308
