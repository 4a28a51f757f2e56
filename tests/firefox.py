"""Firefox, driven by WebDriver BiDi, which it speaks itself: no driver stands between."""

import json
import shutil
import subprocess
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

PROGRAM = shutil.which("firefox") or shutil.which("firefox-esr")
PATIENCE = 60.0  # [s] for a start, and for an answer
# what a script returns is a node, or text; it knows the page's names, those of const among them
CALL = """(...given) => {
  const said = (function () { %s }).apply(null, given);
  return said instanceof Node ? said : JSON.stringify(said) ?? "null";
}"""
IS_READY = "return typeof gBrowser === 'object' && Boolean(gBrowser?.selectedBrowser)"


class Firefox:
    """The Firefox that is installed, without a window."""

    lacks = "" if PROGRAM and find_spec("websocket") else "needs firefox and websocket-client"

    def __init__(self):
        from websocket import create_connection

        self.folder = tempfile.TemporaryDirectory(prefix="firefox_", ignore_cleanup_errors=True)
        self.process = subprocess.Popen(
            [
                *(PROGRAM, "--headless", "--no-remote", "--profile", self.folder.name),
                *("--remote-debugging-port", "0", "--remote-allow-system-access", "about:blank"),
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        address = self._address()
        self.socket = create_connection(address, timeout=PATIENCE, suppress_origin=True)
        self.last, self.events = 0, []
        self.send("session.new", capabilities={})
        self.send("session.subscribe", events=["log.entryAdded", "network.beforeRequestSent"])
        self.window = self._window()
        self.tab = self._contexts()[0]["context"]
        # the keyboard is the page's, not the address bar's
        self._call(self.window, "gBrowser.selectedBrowser.focus()", ())

    def _address(self):
        """Return where it listens, which it writes into its profile."""
        file, end = Path(self.folder.name) / "WebDriverBiDiServer.json", time.monotonic() + PATIENCE
        while not (file.exists() and file.read_text(encoding="utf-8").endswith("}")):
            assert self.process.poll() is None, "Firefox ended"
            assert time.monotonic() < end, "Firefox does not listen"
            time.sleep(0.05)
        at = json.loads(file.read_text(encoding="utf-8"))
        return f"ws://{at['ws_host']}:{at['ws_port']}/session"

    def _contexts(self, **scope):
        return self.send("browsingContext.getTree", **scope)["contexts"]

    def _window(self):
        """Return the browser's window, which is listed before it has loaded."""
        end = time.monotonic() + PATIENCE
        while True:
            for each in self._contexts(**{"moz:scope": "chrome"}):
                loaded = each["url"] != "about:blank"
                if loaded and self._call(each["context"], IS_READY, ()):
                    return each["context"]
            assert time.monotonic() < end, "Firefox opens no window"
            time.sleep(0.05)

    def send(self, method, **parameters):
        """Return the result of a command of WebDriver BiDi."""
        self.last += 1
        self.socket.send(json.dumps({"id": self.last, "method": method, "params": parameters}))
        while True:
            answer = json.loads(self.socket.recv())
            if answer["type"] == "event":
                self.events.append(answer)
            else:
                assert answer["type"] == "success", answer
                return answer["result"]

    def open(self, address):
        self.send("browsingContext.navigate", context=self.tab, url=address, wait="complete")

    def run(self, script, *given):
        return self._call(self.tab, script, given)

    def _call(self, context, script, given):
        answer = self.send(
            "script.callFunction",
            functionDeclaration=CALL % script,
            target={"context": context},
            arguments=[_argument(each) for each in given],
            awaitPromise=False,
            userActivation=True,
        )
        assert answer["type"] == "success", answer
        result = answer["result"]
        return result if result["type"] == "node" else json.loads(result["value"])

    def perform(self, sources):
        self.send("input.performActions", context=self.tab, actions=sources)

    def look(self, width, height, dark):
        size = {"width": width, "height": height}
        self.send("browsingContext.setViewport", context=self.tab, viewport=size)
        scheme = "layout.css.prefers-color-scheme.content-override"
        self._call(self.window, f"Services.prefs.setIntPref('{scheme}', {0 if dark else 1})", ())

    def said(self):
        """Return what the console had to say since it was asked last, and requests that left."""
        self.run("")  # events that were sent before this are here after it
        seen, self.events = [each["params"] for each in self.events], []
        said = [
            each.get("text") for each in seen if each.get("source", {}).get("context") == self.tab
        ]
        asked = [each["request"]["url"] for each in seen if each.get("context") == self.tab]
        return said + [url for url in asked if url.startswith(("http", "ws"))]

    def printed(self):
        return self.send("browsingContext.print", context=self.tab)["data"]

    def quit(self):
        self.socket.close()
        self.process.terminate()
        self.process.wait()
        self.folder.cleanup()


def _argument(value):
    """Return a value as an argument of BiDi: a node as it was returned, others with their type."""
    if isinstance(value, dict):
        return {"sharedId": value["sharedId"]}
    if value is None:
        return {"type": "null"}
    kind = {bool: "boolean", str: "string"}.get(type(value), "number")
    return {"type": kind, "value": value}
