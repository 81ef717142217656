"""Many steps of a small contact in one launch on one core of a CPU, whose cost is paid once a block."""
