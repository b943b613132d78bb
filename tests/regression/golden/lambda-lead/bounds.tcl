# shen-lhdr-bridge: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# Each bound has the peak force and the loop area of its cycle, with a chosen K_2/K_1; its Q_d is therefore not that of the factors, which is half the difference of the forces at zero displacement.
# lower bound: heated cycle at 23 degC, 100% strain; Q_d 220.137 kN, K_1 16.5119, K_2 1.04051 kN/mm
uniaxialMaterial Steel01 1 234.94216034238954 16.511945040247642 0.06301538461538461
# upper bound: first cycle at -20 degC, 100% strain; Q_d 510.853 kN, K_1 28.8901, K_2 2.84456 kN/mm
uniaxialMaterial Steel01 2 566.6455437400268 28.89009855620951 0.09846153846153846
