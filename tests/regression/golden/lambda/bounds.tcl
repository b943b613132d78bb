# shen-hdr-bridge: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# Each bound is a bilinear loop with the stated K_2/K_1, and with the peak force and the area of its cycle. Its force at zero displacement, Q_d, therefore differs from that of the cycle, which the factors use.
# lower bound: heated cycle at 40 degC, 100% strain; Q_d 86.5632 kN, K_1 6.11172, K_2 1.16123 kN/mm
uniaxialMaterial Steel01 1 106.86818863738043 6.111716928770077 0.18999999999999997
# upper bound: first cycle at -20 degC, 100% strain; Q_d 181.046 kN, K_1 19.4613, K_2 3.69764 kN/mm
uniaxialMaterial Steel01 2 223.5130659932827 19.461261188965207 0.18999999999999997
