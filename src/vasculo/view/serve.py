"""A small web server that gives a browser the viewer, and a recording while it still grows."""

from __future__ import annotations

import errno
import socket
import time
import urllib.error
import urllib.request
from contextlib import contextmanager
from functools import cached_property
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Event, Thread, current_thread
from typing import TYPE_CHECKING
from urllib.parse import quote, urlsplit

from vasculo.errors import InputError
from vasculo.view.sdk import rerun

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

HOST = "127.0.0.1"
"""Only this machine can see the run."""
USUAL_PORT = 9797
"""Taken when it is free, so that the browser finds the compiled viewer in its cache; else any free port."""
RECORDING = "/run.rrd"
_POLICY = "default-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' data: blob:"
_PIECE = 1 << 20
_PAUSE = 0.05  # seconds between two looks for more


class Server:
    """Web server of one recording; it stops with the program.

    The viewer itself comes with rerun, whose own server hands out its files. They are passed on with a policy that lets
    the page speak to this server only: so nothing is asked of the internet, and no usage statistics leave the browser.

    Parameters
    ----------
    path : Path
        File of the recording, which may still be written or not be there yet.
    port : int, optional
        Port; a free one when left out.

    Raises
    ------
    InputError
        When the port is in use or cannot be had.
    """

    def __init__(self, path: Path, port: int | None = None) -> None:
        self.path = path
        self._whole = Event()
        self._readers: set[Thread] = set()
        self._server = _listen(port, _handler(self))
        Thread(target=self._server.serve_forever, daemon=True).start()

    @property
    def address(self) -> str:
        """Where a browser finds the viewer."""
        return f"http://{HOST}:{self._server.server_address[1]}/"

    @cached_property
    def assets(self) -> str:
        """Address of rerun's own server of the viewer's files, started when it is first asked for."""
        port = free_port()
        rerun.serve_web_viewer(web_port=port, open_browser=False)
        return f"http://{HOST}:{port}"

    @property
    def whole(self) -> bool:
        """Whether nothing is added to the recording any more."""
        return self._whole.is_set()

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Note that a browser reads the recording in this thread."""
        self._readers.add(current_thread())
        try:
            yield
        finally:
            self._readers.discard(current_thread())

    def finish(self, patience: float = 10.0) -> None:
        """Say that the recording is whole, and wait until every browser has read it, `patience` seconds at most."""
        self._whole.set()
        end = time.monotonic() + patience
        for reader in tuple(self._readers):
            reader.join(max(0.0, end - time.monotonic()))

    def close(self) -> None:
        """Stop."""
        self._whole.set()
        self._server.shutdown()
        self._server.server_close()


def free_port() -> int:
    """Return a port that nobody listens at."""
    with socket.socket() as free:
        free.bind((HOST, 0))
        return int(free.getsockname()[1])


def _listen(port: int | None, handler: type[BaseHTTPRequestHandler]) -> ThreadingHTTPServer:
    """Start to listen, at the usual port or any other when none is given."""
    if port is not None and not 0 < port < 65536:
        raise InputError(f"port {port} does not exist: name one from 1 to 65535")
    for choice in (USUAL_PORT, 0) if port is None else (port,):
        try:
            server = ThreadingHTTPServer((HOST, choice), handler)
        except OSError as error:
            if port is None and choice:
                continue
            reason = "is in use" if error.errno == errno.EADDRINUSE else f"cannot be had ({error.strerror})"
            raise InputError(f"port {port} {reason}: name another one with --port, or leave it out") from None
        server.daemon_threads = True
        return server
    raise AssertionError  # the loop returns or raises


def _handler(owner: Server) -> type[BaseHTTPRequestHandler]:
    """Make the class that answers the requests to a server."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            at = urlsplit(self.path)
            try:
                if at.path == "/" and not at.query:
                    self._redirect()
                elif at.path == RECORDING:
                    self._recording()
                else:
                    self._asset(at.path)
            except (BrokenPipeError, ConnectionResetError):  # the browser was closed
                self.close_connection = True

        def _redirect(self) -> None:
            """Send the browser to the page that opens the recording; by the name it knows this server by."""
            source = quote(f"http://{self.headers.get('Host', '')}{RECORDING}", safe="")
            self.send_response(302)
            self.send_header("Location", f"/?url={source}&persist=0")
            self.send_header("Content-Length", "0")
            self.end_headers()

        def _asset(self, path: str) -> None:
            try:
                with urllib.request.urlopen(owner.assets + quote(path)) as found:  # noqa: S310  # http, this machine
                    body, kind = found.read(), found.headers.get("Content-Type", "application/octet-stream")
            except urllib.error.HTTPError as error:
                self.send_error(error.code)
                return
            self.send_response(200)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Content-Security-Policy", _POLICY)
            self.end_headers()
            self.wfile.write(body)

        def _recording(self) -> None:
            """Send what there is of the recording, and what comes, until it is whole."""
            self.send_response(200)
            self.send_header("Content-Type", "application/octet-stream")
            self.end_headers()
            while not owner.path.exists():
                time.sleep(_PAUSE)
            with owner.reading(), owner.path.open("rb") as file:
                while True:
                    whole = owner.whole
                    if piece := file.read(_PIECE):
                        self.wfile.write(piece)
                    elif whole:
                        return
                    else:
                        time.sleep(_PAUSE)

        def log_message(self, *_: object) -> None:
            """Keep quiet."""

    return Handler
