"""Pages: what a run, a sweep or a report shows in one HTML file that needs no network."""
