"""`python -m englang` is the command `eng`."""

import sys

from ._command import main

sys.exit(main())
