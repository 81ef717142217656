"""What a study may add to the steps of a contact: a film, wear in particles, fretting, and so on."""
