# shen-lhdr-bridge: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# Each bound is a bilinear loop with the stated K_2/K_1, and with the peak force and the area of its cycle. Its force at zero displacement, Q_d, therefore differs from that of the cycle, which the factors use.
# lower bound: heated cycle at 23 degC, 100% strain; Q_d 220.137 kN, K_1 16.5119, K_2 1.04051 kN/mm
uniaxialMaterial Steel01 1 234.94216034238954 16.511945040247642 0.06301538461538461
# upper bound: first cycle at -20 degC, 100% strain; Q_d 510.853 kN, K_1 28.8901, K_2 2.84456 kN/mm
uniaxialMaterial Steel01 2 566.6455437400259 28.890098556209587 0.09846153846153846
