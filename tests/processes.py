"""What tests that start processes need."""

import signal


def interruptible() -> None:
    """In a new process: be interrupted by SIGINT, even if the tests run in the background, where a shell has it ignored."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
