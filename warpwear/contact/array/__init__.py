"""One contact of an array of heights, without a study: from arguments to a solution."""
