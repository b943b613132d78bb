"""The border: text with units becomes plain numbers; clear faults."""
