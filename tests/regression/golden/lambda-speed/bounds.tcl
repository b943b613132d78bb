# lrb-example: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# lower bound: heated cycle at 20 degC, 100% strain; Q_d 145.509 kN, K_1 6.97354, K_2 0.858282 kN/mm
uniaxialMaterial Steel01 1 165.93147924257647 6.973540856062567 0.12307692307692308
# upper bound: first cycle at -20 degC, 100% strain; Q_d 221.158 kN, K_1 7.99635, K_2 0.984167 kN/mm
uniaxialMaterial Steel01 2 252.19813459833233 7.9963542830294445 0.12307692307692308
