"""Ctrl-C and SIGTERM wait for a safe place; the second one does not."""

import signal
import subprocess
import sys
import threading

import pytest

from vasculo.study.patience import Patience


def test_the_first_waits_and_the_second_does_not():
    seen = []

    def work():
        with Patience() as pause:
            pause()
            signal.raise_signal(signal.SIGINT)
            seen.append("still here")
            with pytest.raises(KeyboardInterrupt):
                pause("any", "arguments")
            signal.raise_signal(signal.SIGINT)
            seen.append("never")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert seen == ["still here"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_the_end_of_the_process_waits_too():
    seen = []
    with Patience() as pause:
        signal.raise_signal(signal.SIGTERM)
        seen.append("still here")
        with pytest.raises(KeyboardInterrupt):
            pause()
    assert seen == ["still here"]
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def test_the_second_end_of_the_process_does_not_wait():
    code = (
        "import signal\nfrom vasculo.study.patience import Patience\nwith Patience():\n"
        "    signal.raise_signal(signal.SIGTERM)\n    print('still here', flush=True)\n"
        "    signal.raise_signal(signal.SIGTERM)\n    print('never', flush=True)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == -signal.SIGTERM
    assert done.stdout == "still here\n"


def test_ignored_stays_ignored():
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with Patience() as pause:
            signal.raise_signal(signal.SIGINT)
            pause()
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def test_another_thread_changes_nothing():
    found = []

    def work():
        with Patience():
            found.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert found == [signal.default_int_handler]
