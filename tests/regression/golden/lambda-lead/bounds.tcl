# shen-lhdr-bridge: bilinear bounds of ONE bearing, units kN, mm, s.
# Use one of the materials in a zeroLength element, direction 1, per bearing.
# Each bound is a bilinear loop that matches peak force and energy of its cycle; its Q_d is therefore larger than that of the real loop, which the factors use.
# K_1 follows from K_2 by the usual ratio of its kind. Of a lead rubber bearing the report and links.txt of a bridge state a larger K_1, the initial stiffness of its model.
# The lower and the upper bound are of tested rubber. As a rule, that of virgin rubber governs forces and the lower one displacements.
# lower bound: heated cycle at 23 degC, 100% strain; Q_d 220.137 kN, K_1 16.5119, K_2 1.04051 kN/mm
uniaxialMaterial Steel01 1 234.94216034238923 16.51194504024768 0.06301538461538461
# upper bound: first cycle at -20 degC, 100% strain; Q_d 510.853 kN, K_1 28.8901, K_2 2.84456 kN/mm
uniaxialMaterial Steel01 2 566.6455437400258 28.890098556209605 0.09846153846153846
# virgin bound: first cycle at -20 degC, 100% strain; Q_d 609.527 kN, K_1 44.7597, K_2 3.52568 kN/mm
uniaxialMaterial Steel01 3 661.6438984520603 44.75966477257963 0.07876923076923077
