"""`python -m englang` is the command `eng`."""

import sys

from ._command import main

if __name__ == "__main__":
    sys.exit(main())
