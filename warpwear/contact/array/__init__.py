"""One contact of an array of heights, without a study: what is asked, solved, and handed back."""
