"""The web server: what it hands out, to whom, and what it says when it cannot."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import urllib.error
import urllib.request

import pytest

from vasculo.errors import InputError
from vasculo.view.sdk import without_statistics
from vasculo.view.serve import Server
from vasculo.view.show import show_browser, show_window


@pytest.fixture
def server(tmp_path):
    path = tmp_path / "run.rrd"
    path.write_bytes(b"begin")
    made = Server(path)
    yield made
    made.close()


def get(server, path):
    return urllib.request.urlopen(server.address + path, timeout=20.0)  # noqa: S310  # http, this machine


def test_a_recording_is_sent_while_it_grows_until_it_is_whole(server):
    got = []
    reader = threading.Thread(target=lambda: got.append(get(server, "run.rrd").read()))
    reader.start()
    with server.path.open("ab") as file:
        file.write(b" and end")
    server.finish()
    reader.join(10.0)
    assert got == [b"begin and end"]


def test_the_page_comes_with_rerun_and_may_speak_to_this_server_only(server):
    with get(server, "") as page:
        text, policy = page.read().decode(), page.headers["Content-Security-Policy"]
        assert page.url.startswith(f"{server.address}?url=http%3A%2F%2F127.0.0.1%3A")
    assert "re_viewer" in text
    assert policy.startswith("default-src 'self' ")
    assert "http" not in policy
    with get(server, "re_viewer_bg.wasm") as viewer:
        assert viewer.headers["Content-Type"] == "application/wasm"
        assert viewer.read(4) == b"\0asm"
    with pytest.raises(urllib.error.HTTPError, match="404"):
        get(server, "nothing/here")


def test_only_this_machine_is_answered(server):
    assert server.address.startswith("http://127.0.0.1:")


def test_a_port_in_use_is_one_line_with_its_number(tissue_run):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=f"port {port} is in use: name another one with --port"):
            show_browser(tissue_run, port=port, open_it=False, tell=lambda _: None)


@pytest.mark.parametrize("port", [0, -1, 65536])
def test_a_port_that_does_not_exist_is_refused(tmp_path, port):
    with pytest.raises(InputError, match=f"port {port} does not exist"):
        Server(tmp_path / "run.rrd", port)


def test_a_window_without_a_display_is_refused(tissue_run, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(InputError, match="no display"):
        show_window(tissue_run)


def test_programs_of_rerun_are_started_without_statistics(monkeypatch):
    monkeypatch.delenv("CI", raising=False)
    with without_statistics():
        assert os.environ["CI"]
    assert "CI" not in os.environ


def test_the_command_serves_until_it_is_stopped_and_tidies_up(tissue_run, tmp_path):
    command = [sys.executable, "-u", "-m", "vasculo", "view", str(tissue_run.folder), "--no-open"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, text=True, env={**os.environ, "TMPDIR": str(tmp_path)}
    ) as viewer:
        address = viewer.stdout.readline().split(" at ")[1].strip()
        with urllib.request.urlopen(f"{address}run.rrd", timeout=60.0) as recording:  # noqa: S310  # the same
            assert recording.read(4) == b"RRF2"
        viewer.send_signal(signal.SIGTERM)
        assert viewer.wait(20.0) == 0
    assert not any(tmp_path.glob("vasculo-view-*"))


def test_a_browser_that_is_closed_in_the_middle_harms_nobody(server):
    with contextlib.closing(socket.create_connection(("127.0.0.1", int(server.address.split(":")[2][:-1])))) as left:
        left.sendall(b"GET /run.rrd HTTP/1.0\r\n\r\n")
        left.recv(10)
    with server.path.open("ab") as file:
        file.write(b"x" * 4_000_000)
    server.finish()
    with get(server, "run.rrd") as again:
        assert len(again.read()) == 4_000_005
