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
SCHEME = 'user_pref("layout.css.prefers-color-scheme.content-override", %d);\n'


class Firefox:
    """The Firefox that is installed, without a window."""

    lacks = "" if PROGRAM and find_spec("websocket") else "needs firefox and websocket-client"

    def __init__(self):
        self.address = "about:blank"
        self._start(dark=False)

    def _start(self, dark):
        self.dark = dark
        self.folder = tempfile.TemporaryDirectory(prefix="firefox_", ignore_cleanup_errors=True)
        preferences = Path(self.folder.name) / "user.js"
        preferences.write_text(SCHEME % (0 if dark else 1), encoding="utf-8")
        self.process = subprocess.Popen(
            [
                *(PROGRAM, "--headless", "--no-remote", "--profile", self.folder.name),
                *("--remote-debugging-port", "0", "about:blank"),
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            self._connect()
        except BaseException:
            self._end()
            raise

    def _connect(self):
        from websocket import create_connection

        address = self._address()
        self.socket = create_connection(address, timeout=PATIENCE, suppress_origin=True)
        self.last, self.events = 0, []
        self.send("session.new", capabilities={})
        self.send("session.subscribe", events=["log.entryAdded", "network.beforeRequestSent"])
        # a tab that is opened has the keyboard; the first, of a window without a screen, has not
        self.tab = self.send("browsingContext.create", type="tab")["context"]
        self.send("browsingContext.activate", context=self.tab)

    def _address(self):
        """Return where it listens, which it writes into its profile."""
        file, end = Path(self.folder.name) / "WebDriverBiDiServer.json", time.monotonic() + PATIENCE
        while not (file.exists() and file.read_text(encoding="utf-8").endswith("}")):
            assert self.process.poll() is None, "Firefox ended"
            assert time.monotonic() < end, "Firefox does not listen"
            time.sleep(0.05)
        at = json.loads(file.read_text(encoding="utf-8"))
        return f"ws://{at['ws_host']}:{at['ws_port']}/session"

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
        self.address = address
        self.send("browsingContext.navigate", context=self.tab, url=address, wait="complete")

    def run(self, script, *given):
        answer = self.send(
            "script.callFunction",
            functionDeclaration=CALL % script,
            target={"context": self.tab},
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
        if dark != self.dark:  # which no command changes
            self.quit()
            self._start(dark)
            self.open(self.address)
        size = {"width": width, "height": height}
        self.send("browsingContext.setViewport", context=self.tab, viewport=size)

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
        self._end()

    def _end(self):
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
