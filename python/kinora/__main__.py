"""The command `kinora`."""

import signal
import sys

from . import _kinora


def main() -> int:
    """Runs the command with the arguments of this process."""
    # The command has handlers of its own, which finish the current frame; Python's would raise an exception besides.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _kinora.main(["kinora", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
