"""`python -m elitescript`."""

import sys

from elitescript.cli.main import main

sys.exit(main())
