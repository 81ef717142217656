"""`python -m warpwear` is the command line."""

from warpwear.cli.main import main

main()
