"""Steps of a ball that slides over a track of the disc."""
