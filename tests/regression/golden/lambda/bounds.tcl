# shen-hdr-bridge: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# lower bound: heated cycle at 40 degC, 100% strain; Q_d 81.5028 kN, K_1 7.87045, K_2 1.21084 kN/mm
uniaxialMaterial Steel01 1 96.32148160079956 7.870449469495858 0.15384615384615385
# upper bound: first cycle at -20 degC, 100% strain; Q_d 175.24 kN, K_1 24.4046, K_2 3.75456 kN/mm
uniaxialMaterial Steel01 2 207.10142969300716 24.404642167814114 0.15384615384615385
