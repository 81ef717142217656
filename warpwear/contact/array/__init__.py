"""An array of heights is solved for one contact, without a study: from arguments to a solution."""
