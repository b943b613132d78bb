# lrb-example: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# lower bound: heated cycle at 20 degC, 100% strain; Q_d 147.089 kN, K_1 6.96353, K_2 0.857049 kN/mm
uniaxialMaterial Steel01 1 167.7326411316854 6.963526293866748 0.12307692307692308
# upper bound: first cycle at -20 degC, 100% strain; Q_d 221.405 kN, K_1 7.99942, K_2 0.984544 kN/mm
uniaxialMaterial Steel01 2 252.47886166249546 7.99941603726534 0.12307692307692308
