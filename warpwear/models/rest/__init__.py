"""Steps of a ball that stays on the same cells of the disc."""
