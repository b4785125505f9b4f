"""`python -m vasculo` does what `vasculo` does."""

from vasculo.cli import main

main()
