"""What the variables of a study are called in its tables and histories."""

BEARING = (
    "work_in",
    "heat_released",
    "recoverable",
    "heat_stored",
    "heat_lost_ends",
    "heat_lost_sides",
)
# Of the actuator: in a laboratory only.
STRUCTURE = ("input", "kinetic", "damping", "springs", "hinges", "bearings", "actuator")
COLUMNS = {  # of the table: name in the dataset, factor
    "bearing_strain_max": ("bearing_strain_max", 1.0),
    "bearing_force_max_kN": ("bearing_force_max", 1.0),
    "bearing_energy_kN_mm": ("bearing_energy_end", 1.0),
    "pier_displacement_max_mm": ("pier_displacement_max", 1.0),
    "pier_ductility": ("pier_ductility", 1.0),
    "pier_moment_max_kN_m": ("pier_moment_max", 1.0),
    "deck_displacement_max_mm": ("deck_displacement_max", 1.0),
    "deck_acceleration_max_m_s2": ("deck_acceleration_max", 1.0),
    "pier_top_acceleration_max_m_s2": ("pier_top_acceleration_max", 1.0),
    "pier_top_displacement_max_mm": ("pier_top_displacement_max", 1.0),
    "pier_displacement_residual_mm": ("pier_displacement_residual", 1.0),
}
PLACES = {  # columns that name the governing line or pier: dimension, peak of the parts
    "strain_line": ("line", "line_strain_max"),
    "force_line": ("line", "line_force_max"),
    "displacement_pier": ("pier_part", "pier_part_displacement_max"),
    "ductility_pier": ("pier_part", "pier_part_ductility"),
}
LOOP = {  # of the largest loop: name in the dataset
    "loop_F_plus_kN": "loop_force_max",
    "loop_F_minus_kN": "loop_force_min",
    "loop_D_plus_mm": "loop_displacement_max",
    "loop_D_minus_mm": "loop_displacement_min",
    "loop_K_eq_kN_mm": "loop_stiffness",
    "loop_h_eq": "loop_damping_ratio",
    "loop_G_e_MPa": "loop_modulus",
    "loop_energy_kN_mm": "loop_energy",
}
LABELS = ("bearing", "motion", "ambient", "mode")  # of a run
HISTORY = {  # columns of a history: name in the dataset
    "time_s": "time",
    "ground_m_s2": "ground_acceleration",
    "displacement_mm": "bearing_displacement",
    "strain": "bearing_strain",
    "force_kN": "bearing_force",
    "rubber_force_kN": "rubber_force",
    "lead_force_kN": "lead_force",
    "viscous_force_kN": "viscous_force",
    "energy_kN_mm": "bearing_energy",
    "pier_displacement_mm": "pier_displacement",
    "pier_rotation_rad": "pier_rotation",
    "pier_moment_kN_m": "pier_moment",
    "pier_top_acceleration_m_s2": "pier_top_acceleration",
    "deck_displacement_mm": "deck_displacement",
    "deck_acceleration_m_s2": "deck_acceleration",
    "lead_degC": "lead_temperature",
}
