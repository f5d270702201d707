"""What the tests of the operator's console share: the program, a page of it in a browser, a program that
watches, and a network between them that can be cut."""
import base64
import collections
import contextlib
import json
import os
import pathlib
import re
import select
import signal
import socket
import struct
import subprocess
import threading
import time

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.remote.command import Command

kStopWithin_s = 0.1      # from a stop on record until no current is measured
kPressedWithin_s = 0.25  # from the press itself until then, with what the browser on this machine takes
kFaultWithin_s = 0.6     # from a page that is gone until then
kSilent = "the operator's page is silent"
kGone = "the operator's page is "  # as it closes, it may still say that it is hidden
kHidden = "the operator's page is hidden"


def wait_until(condition, what, within_s=10.0):
    """What `condition` gives, once that is something; `what` is said otherwise, or gives what to say."""
    deadline_s = time.monotonic() + within_s
    while not (found := condition()):
        assert time.monotonic() < deadline_s, f"not within {within_s} s: {what() if callable(what) else what}"
        time.sleep(0.02)
    return found


class Console:
    """`lodestone console` on a virtual rig, and its record."""

    def __init__(self, program, folder, *arguments):
        self.folder = pathlib.Path(folder)
        self.process = subprocess.Popen(
            [program, "console", "--no-open", "--port", "0", "--out", folder, *(arguments or ["--virtual"])],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.url = self.process.stdout.readline().strip()
        assert self.url, f"the console ended with {self.process.wait()}"
        self.port = int(re.search(r":(\d+)/", self.url)[1])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(20)
        assert code in (0, 130), f"the console ended with {code}"

    def events(self):
        lines = (self.folder / "events.jsonl").read_text().split("\n")
        return [json.loads(line) for line in lines[:-1]]  # the last one may still be written

    def event_after(self, count, text, within_s=5.0):
        """The first event with `text` beyond the first `count` ones."""
        found = lambda: next((event for event in self.events()[count:] if text in event["text"]), None)
        return wait_until(found, lambda: f"event {text!r} in {self.events()[count:]}", within_s)

    def memory_MB(self):
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024


def handshake(port, host=None, **headers):
    """The first line of the answer to a request for a WebSocket, and its socket."""
    link = socket.create_connection(("127.0.0.1", port), 10)
    key = base64.b64encode(os.urandom(16)).decode()
    asked = {"Host": host or f"127.0.0.1:{port}", "Upgrade": "websocket", "Connection": "Upgrade",
             "Sec-WebSocket-Key": key, "Sec-WebSocket-Version": "13", **headers}
    lines = ["GET /ws HTTP/1.1", *(f"{name}: {value}" for name, value in asked.items()), "", ""]
    link.sendall("\r\n".join(lines).encode())
    answer = b""
    while b"\r\n\r\n" not in answer and (byte := link.recv(1)):
        answer += byte
    return answer.split(b"\r\n")[0].decode(), link


class Watcher:
    """A program that watches: the state, the clock of the bench, what was answered, and when."""

    def __init__(self, port):
        said, self.link = handshake(port)
        assert " 101 " in said, said
        self.state = None  # the last one: what is kept for hours is looked through by every collection of garbage
        self.messages = collections.deque(maxlen=10000)
        self.on = []          # times at which a coil held a current though nothing was running
        self.ahead_s = float("inf")  # our clock, of the bench's
        self.sending = threading.Lock()
        self.thread = threading.Thread(target=self.listen, daemon=True)
        self.thread.start()
        self.send({"do": "more", "of": "state"})
        wait_until(lambda: self.state, "a state")

    def send(self, message):
        text = json.dumps(message).encode()
        mask = os.urandom(4)
        size = bytes([0x80 | len(text)]) if len(text) < 126 else b"\xfe" + struct.pack(">H", len(text))
        with self.sending:
            masked = bytes(byte ^ mask[i % 4] for i, byte in enumerate(text))
            self.link.sendall(b"\x81" + size + mask + masked)

    def ask(self, message):
        """What is answered to `message`."""
        before = len(self.messages)
        self.send(message)
        asked = {"kind": "answer", "to": message["do"]}
        answers = lambda: [m for m in list(self.messages)[before:] if asked.items() <= m.items()]
        return wait_until(answers, f"an answer to {message}")[0]

    def listen(self):
        with contextlib.suppress(OSError, EOFError), self.link.makefile("rb") as stream:
            while True:
                opcode, content = self.read_frame(stream)
                if opcode == 8:
                    return
                if opcode == 1:
                    self.hear(json.loads(content))

    def read_frame(self, stream):
        def read(count):
            content = stream.read(count)
            if len(content) < count:
                raise EOFError
            return content
        opcode, size = read(2)
        if size >= 126:
            size = int.from_bytes(read(2 if size == 126 else 8), "big")
        return opcode & 0xF, read(size)

    def hear(self, message):
        message["heard_s"] = time.monotonic()
        if message["kind"] != "state":
            return self.messages.append(message)
        if message["mode"] == "disconnected":
            self.ahead_s = float("inf")  # it is the rig's clock that counts
        else:  # what took longest to come is furthest from the truth
            self.ahead_s = min(self.ahead_s, message["heard_s"] - message["time_s"])
        if any(message["on_A"]) and message["mode"] != "running":
            self.on.append(message["time_s"])
        self.state = message
        self.send({"do": "more", "of": "state"})

    def stopped(self, console, count, since_s, within_s, reason):
        """Milliseconds from `since_s` on our clock until no current was measured, after a stop for `reason`:
        by the clock of the bench, as it is on record, or by ours, as this program was told of it, whichever
        says more. `count`: of the events before."""
        stop = console.event_after(count, "stop: ")
        assert reason in stop["text"], f"{stop}, not {reason!r}"
        off = console.event_after(count, "coils off, as measured")
        after_stop_s = off["time_s"] - stop["time_s"]
        assert 0.0 <= after_stop_s <= kStopWithin_s, f"off {1e3 * after_stop_s:.0f} ms after the stop"
        told = lambda: [m for m in list(self.messages) if off.items() <= m.items()]
        heard_s = wait_until(told, "word of it")[0]["heard_s"]
        took_s = max(off["time_s"] - (since_s - self.ahead_s), heard_s - since_s)
        assert took_s <= within_s, f"off after {1e3 * took_s:.0f} ms: {console.events()[count:]}"
        return 1e3 * took_s

    def close(self):
        self.link.shutdown(socket.SHUT_RDWR)
        self.thread.join()

    def check_off(self, events):
        """No coil held a current while nothing was running, but for what a stop takes."""
        stops = [event["time_s"] for event in events if event["text"].startswith("stop: ")]
        stopping = lambda time_s: any(0.0 <= time_s - stop_s <= kStopWithin_s for stop_s in stops)
        unsafe = [on_s for on_s in self.on if not stopping(on_s)]
        assert not unsafe, f"coils held a current though nothing was running: {unsafe}"


class Proxy:
    """A network between a browser and the console."""

    def __init__(self, port):
        self.to = port
        self.door = socket.create_server(("127.0.0.1", 0))
        self.port = self.door.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}/"
        self.held = set()   # sockets that nothing is read from any more
        self.peers = {}     # of each socket, the other end
        self.lock = threading.Lock()
        threading.Thread(target=self.forward, daemon=True).start()

    def forward(self):
        while True:
            with self.lock:
                waiting = [self.door, *(link for link in self.peers if link not in self.held)]
            for ready in select.select(waiting, [], [], 0.02)[0]:
                with self.lock:
                    self.accept() if ready is self.door else self.pass_on(ready)

    def accept(self):
        page = self.door.accept()[0]
        console = socket.create_connection(("127.0.0.1", self.to))
        self.peers.update({page: console, console: page})

    def pass_on(self, link):
        if link not in self.peers or link in self.held:
            return
        try:
            content = link.recv(1 << 16)
            self.peers[link].sendall(content)
        except OSError:
            content = b""
        if not content:
            self.drop(link)

    def drop(self, link):
        for each in (link, self.peers.pop(link)):
            self.peers.pop(each, None)
            self.held.discard(each)
            each.close()

    def hold(self):
        """Nothing passes either way on the connections that there are, and none of them is closed."""
        with self.lock:
            self.held.update(self.peers)

    def cut(self):
        with self.lock:
            for link in list(self.peers):
                if link in self.peers:
                    self.drop(link)


def processes_below(pid):
    """Of a process, all that it and its own have started."""
    below = []
    with contextlib.suppress(OSError):  # it has ended
        for thread in pathlib.Path(f"/proc/{pid}/task").iterdir():
            below += map(int, (thread / "children").read_text().split())
    return below + [each for child in below for each in processes_below(child)]


# Before the page hears of an input, when it came into being.
kNoteInput = """for (const kind of ['pointerdown', 'keydown']) addEventListener(kind, event => {
  window.pressed_ms = Date.now() - performance.now() + event.timeStamp; }, true)"""


class Browser:
    """Chromium without a screen."""

    def __init__(self, width_px=1400, height_px=900):
        options = Options()
        options.binary_location = "/usr/bin/chromium"
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                         f"--window-size={width_px},{height_px}",
                         "--host-resolver-rules=MAP evil.example 127.0.0.1"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.service = Service("/usr/bin/chromedriver")
        self.driver = webdriver.Chrome(service=self.service, options=options)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        with contextlib.suppress(Exception):
            self.driver.quit()
        self.kill()
        self.service.stop()

    def kill(self):
        for pid in processes_below(self.service.process.pid):
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)

    @contextlib.contextmanager
    def tab_in_front(self):
        """Hides the page that is in front."""
        self.driver.switch_to.new_window("tab")
        tab = self.driver.current_window_handle
        yield
        self.driver.execute(Command.SWITCH_TO_WINDOW, {"handle": tab})
        self.driver.close()

    def page(self, url, kind=None):
        """A page of the console; `kind`: in a `tab` or `window` of its own."""
        if kind:
            self.driver.switch_to.new_window(kind)
        self.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": kNoteInput})
        self.driver.get(url)
        return Page(self.driver)


class Page:
    """A page of the console, and what its operator does."""

    def __init__(self, driver):
        self.driver = driver
        self.handle = driver.current_window_handle
        self.wait_for(lambda: self.connected, "a connection")

    def script(self, code, *arguments):
        self.driver.execute(Command.SWITCH_TO_WINDOW, {"handle": self.handle})  # the last may be closed
        return self.driver.execute_script(code, *arguments)

    def do(self, command, **parameters):
        """A command of the Chrome DevTools protocol."""
        self.script("")
        return self.driver.execute_cdp_cmd(command, parameters)

    def element(self, name):
        self.script("")
        return self.driver.find_element(By.ID, name)

    def click(self, name):
        self.wait_for(lambda: self.element(name).is_enabled(), f"{name} is enabled")
        # Not under the top.
        self.script("document.getElementById(arguments[0]).scrollIntoView({block: 'center'})", name)
        self.element(name).click()

    def text(self, name):
        return self.script("return document.getElementById(arguments[0]).textContent", name)

    @property
    def state(self):
        return self.script("return window.lodestone.lastState")

    @property
    def connected(self):
        return self.script("return document.body.dataset.connected === 'true' && "
                           "!!window.lodestone.lastState")

    @property
    def operating(self):
        return self.script("return document.body.dataset.operating === 'true'")

    @property
    def mode(self):
        return self.script("return document.body.dataset.mode")

    @property
    def said(self):
        return f"{self.mode}, {self.text('reason')}"

    def wait_for(self, condition, what, within_s=10.0):
        return wait_until(condition, what, within_s)

    def wait_for_mode(self, mode, within_s=10.0):
        wait_until(lambda: self.mode == mode, lambda: f"{mode}; it is {self.said}", within_s)

    def shows_stop(self, reason, within_s=10.0):
        """The page says that the bench is stopped, and why."""
        wait_until(lambda: self.connected and self.mode == "stopped" and reason in self.text("reason"),
                   lambda: f"stopped: {reason}; it is {self.said}", within_s)

    def ready(self):
        """Has the seat, and the bench armed, however often a page that is slow to come is taken for silent."""
        self.wait_for(lambda: self.connected, "a connection")
        asks_s = time.monotonic() + 2.0  # a page that is loaded asks for an empty seat; a click then would give it back
        while not self.operating and time.monotonic() < asks_s:
            time.sleep(0.05)
        wait_until(self.armed, lambda: f"armed; it is {self.said}", 30.0)
        return self

    def armed(self):
        """Takes one step towards it; whether it is there."""
        if not self.operating:
            self.click("operate")
            self.wait_for(lambda: self.operating, "the seat", 20.0)
        mode = self.mode
        if mode == "running":
            self.click("end")
        elif mode in ("stopped", "disarmed"):
            self.click("arm")
            if mode == "stopped":
                self.click("dialog-yes")
        if mode != "armed":
            self.wait_for(lambda: self.mode != mode, lambda: f"something else than {self.said}")
        return mode == "armed"

    def choose(self, controller):
        self.driver.find_element(By.CSS_SELECTOR, f"#controller option[value={controller}]").click()
        self.wait_for(lambda: self.state["controller"] == controller, controller)

    def place_px(self, place):
        left, top, width, height = self.script(
            "const view = document.getElementById('view'); view.scrollIntoView({block: 'nearest'});"
            "const box = view.getBoundingClientRect(); return [box.left, box.top, box.width, box.height];")
        return {"x": left + place[0] * width, "y": top + place[1] * height}

    def mouse(self, kind, place):
        self.do("Input.dispatchMouseEvent", type=f"mouse{kind}", button="left",
                buttons=int(kind != "Released"), clickCount=1, **place)

    def point(self, place):
        """A click in the image."""
        at = self.place_px(place)
        self.mouse("Pressed", at)
        self.mouse("Released", at)

    def draw(self, places):
        at = [self.place_px(place) for place in places]
        self.mouse("Pressed", at[0])
        for each in at[1:]:
            self.mouse("Moved", each)
        self.mouse("Released", at[-1])

    def key(self, kind, code):
        self.do("Input.dispatchKeyEvent", type=f"key{kind}", code=code, key={"Space": " "}.get(code, code),
                windowsVirtualKeyCode={"Space": 32, "Escape": 27, "ArrowRight": 39, "ArrowLeft": 37, "ArrowUp": 38,
                                       "Enter": 13, "Tab": 9}[code],
                text={"Enter": "\r"}.get(code, "") if kind == "Down" else "")

    def press(self, code):
        self.key("Down", code)
        self.key("Up", code)

    @property
    def focus(self):
        """What the keyboard speaks to."""
        return self.script("return document.activeElement.id")

    def seen(self, within_s):
        """Where the needle is seen, at the latest after so long; None where it is not."""
        deadline_s = time.monotonic() + within_s
        while not (middle := (self.state["pose"] or {}).get("middle")) and time.monotonic() < deadline_s:
            time.sleep(0.05)
        return middle

    def drive(self):
        """A run that has a way to go: the coils are at work. Begun again where the machine is so busy that the
        page was silent."""
        begun = lambda: self.mode == "stopped" or (self.state["run"] or {}).get("steps", 0) >= 2
        for _ in range(3):
            here = self.seen(3.0) or [0.5, 0.5]  # a needle that is not seen is looked for by the run
            self.point(max(([0.38, 0.4], [0.62, 0.6]), key=lambda place: distance(place, here)))
            self.wait_for(begun, lambda: f"two steps; it is {self.said}")
            if self.mode == "running":
                return self
            self.ready()
        raise AssertionError(f"no run lasts: {self.said}")

    def errors(self):
        self.script("")
        return [entry for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]

    def errors_are_none(self):
        assert not (errors := self.errors()), errors

    def picture(self, name, folder):
        """Kept in `folder`, where there is one."""
        if folder:
            pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
            self.script("")
            self.driver.save_screenshot(f"{folder}/{name}.png")


def distance(a, b):
    return ((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) ** 0.5
