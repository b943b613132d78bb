"""Studies of very many runs: factors, designs, an engine, a store, and what is drawn from it."""
