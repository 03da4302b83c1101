# SPDX-License-Identifier: BSD-3-Clause
"""Where the command starts: so early that Ctrl-C ends it with one line while it loads, too."""

from __future__ import annotations

import sys

from .interruption import INTERRUPTED, report


def main() -> int:
    """Run the command line; return the exit code."""
    try:
        from . import cli

        return cli.main()
    except KeyboardInterrupt:
        report()
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
