"""Opens pages in headless Chromium and drives them: no packages are needed beyond Python's own.

    with Browser() as browser:
        page = browser.open("pose.html", 1280, 720)
        page.evaluate("vpm.setStep(3)")
        page.screenshot("pose.png")

usage as a program: headless_page.py PAGE.html PICTURE.png [JAVASCRIPT to run before the picture is taken]
"""
import base64
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

PROGRAMS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")  # the first begins soonest
# WebGL by the processor: test machines have no graphics.
OPTIONS = ("--headless", "--no-sandbox", "--remote-debugging-pipe", "--use-gl=angle", "--use-angle=swiftshader",
           "--enable-unsafe-swiftshader", "--hide-scrollbars", "--no-first-run", "--disable-extensions",
           "--disable-background-networking", "--disable-renderer-backgrounding",
           "--disable-backgrounding-occluded-windows", "--disable-dev-shm-usage", "--force-device-scale-factor=1")
PATIENCE = 120  # s


def program():
    """Returns the path of a Chromium, or None."""
    return next((path for path in map(shutil.which, PROGRAMS) if path), None)


class Browser:
    """Speaks the DevTools protocol over two pipes: a JSON message ends with a zero byte."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory(prefix="vpm-browser-")
        child_in, self.to_child = os.pipe()
        self.from_child, child_out = os.pipe()

        def take_pipes():  # the protocol uses descriptors 3 and 4
            first, second = os.dup(child_in), os.dup(child_out)
            os.dup2(first, 3)
            os.dup2(second, 4)

        self.process = subprocess.Popen(
            [program(), *OPTIONS, f"--user-data-dir={self.folder.name}", "about:blank"],
            preexec_fn=take_pipes, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(child_in)
        os.close(child_out)
        self.buffer, self.last, self.events = b"", 0, []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("Browser.close")
            self.process.wait(10)
        except (OSError, RuntimeError, subprocess.TimeoutExpired):
            self.process.kill()
        os.close(self.to_child)
        os.close(self.from_child)
        self.process.wait()
        self.folder.cleanup()

    def receive(self):
        while b"\0" not in self.buffer:
            part = os.read(self.from_child, 1 << 20)
            if not part:
                raise RuntimeError("Chromium has ended")
            self.buffer += part
        message, _, self.buffer = self.buffer.partition(b"\0")
        return json.loads(message)

    def call(self, method, session=None, **parameters):
        """Returns the answer; events that come before it are kept."""
        self.last += 1
        request = {"id": self.last, "method": method, "params": parameters}
        if session:
            request["sessionId"] = session
        os.write(self.to_child, json.dumps(request).encode() + b"\0")
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            message = self.receive()
            if message.get("id") != self.last:
                self.events.append(message)
            elif "error" in message:
                raise RuntimeError(f"{method}: {message['error']['message']}")
            else:
                return message["result"]
        raise RuntimeError(f"{method}: no answer in {PATIENCE} s")

    def open(self, path, width=1280, height=720, phone=False):
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        return Page(self, target, session, path, width, height, phone)


class Page:
    """A file that is open; `faults` are what its console said of errors and warnings."""

    def __init__(self, browser, target, session, path, width, height, phone):
        self.browser, self.target, self.session = browser, target, session
        for domain in ("Runtime", "Log", "Page", "Network"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)
        if phone:
            self.call("Emulation.setTouchEmulationEnabled", enabled=True)
        begin = time.monotonic()
        self.call("Page.navigate", url=pathlib.Path(path).resolve().as_uri())
        while not self.evaluate("Boolean(window.vpm && vpm.report().firstPicture > 0)"):
            if self.faults or time.monotonic() - begin > PATIENCE:
                break
            time.sleep(0.02)
        self.seconds = time.monotonic() - begin

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def evaluate(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return answer["result"].get("value")

    def report(self):
        return self.evaluate("vpm.report()")

    def settle(self):
        """Waits until what was asked for is drawn."""
        self.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def screenshot(self, path=None):
        """Returns the window as PNG, and writes it."""
        self.settle()
        png = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        if path:
            pathlib.Path(path).write_bytes(png)
        return png

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1, **more)

    @property
    def faults(self):
        found = []
        for event in self.browser.events:
            if event.get("sessionId") != self.session:
                continue
            parameters = event.get("params", {})
            if event["method"] == "Runtime.exceptionThrown":
                details = parameters["exceptionDetails"]
                found.append(details.get("exception", {}).get("description", details["text"]))
            if event["method"] == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning"):
                found.append(" ".join(str(a.get("value", "")) for a in parameters["args"]))
            if event["method"] == "Log.entryAdded" and parameters["entry"]["level"] == "error":
                found.append(parameters["entry"]["text"])
        return found

    @property
    def requests(self):
        """Addresses that the page asked for, itself among them."""
        return [event["params"]["request"]["url"] for event in self.browser.events
                if event.get("sessionId") == self.session and event["method"] == "Network.requestWillBeSent"]

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)


def main():
    if len(sys.argv) not in (3, 4):
        print(__doc__, file=sys.stderr)
        return 2
    if not program():
        sys.exit("headless_page.py: there is no Chromium; install it (Debian: chromium-headless-shell)")
    with Browser() as browser:
        page = browser.open(pathlib.Path(sys.argv[1]).resolve())
        if len(sys.argv) == 4:
            page.evaluate(sys.argv[3])
        page.screenshot(pathlib.Path(sys.argv[2]))
        for fault in page.faults:
            print(f"headless_page.py: {sys.argv[1]}: {fault}", file=sys.stderr)
        return 1 if page.faults else 0


if __name__ == "__main__":
    sys.exit(main())
