# lrb-example: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# lower bound: heated cycle at 20 degC, 100% strain; Q_d 145.509 kN, K_1 6.97348, K_2 0.858275 kN/mm
uniaxialMaterial Steel01 1 165.93148487279095 6.973484468246219 0.12307692307692307
# upper bound: first cycle at -20 degC, 100% strain; Q_d 221.158 kN, K_1 7.99635, K_2 0.984166 kN/mm
uniaxialMaterial Steel01 2 252.1981657318044 7.996350411974843 0.12307692307692308
