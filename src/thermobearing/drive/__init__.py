"""Who moves the bearing: protocols, ambient temperature, trial steps for outside solvers."""
