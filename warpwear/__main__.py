"""`python -m warpwear`."""

from warpwear.cli import main

main()
