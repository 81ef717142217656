"""What wear has left on a measured surface: the cap of a ball, the track of a disc."""
