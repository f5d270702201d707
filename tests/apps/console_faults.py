"""What can happen to the operator of a console in mid-run, and that the coils are then off in time."""
import contextlib
import os
import signal
import time

from console_page import (Browser, Console, Proxy, Watcher, kFaultWithin_s, kGone, kHidden, kPressedWithin_s,
                          kSilent, processes_below)


class Operator:
    """A console, who operates it in a browser behind a network of its own, and a program that watches."""

    def __init__(self, program, folder, *arguments):
        self.console = Console(program, folder, *arguments)
        self.watcher = Watcher(self.console.port)
        self.proxy = Proxy(self.console.port)
        self.browser = self.page = None

    def __enter__(self):
        self.open()
        return self

    def __exit__(self, *failure):
        self.browser.__exit__()
        self.console.__exit__()

    def open(self):
        """The console, in a window beside an empty one."""
        self.browser = self.browser or Browser()
        self.spare = self.browser.driver.current_window_handle
        self.page = self.browser.page(self.proxy.url, "window")

    # Each goes on where the operator has come back.

    @contextlib.contextmanager
    def killed(self):
        self.browser.kill()
        yield
        self.browser.__exit__()
        self.browser = None
        self.open()

    @contextlib.contextmanager
    def closed(self):
        self.browser.driver.close()
        yield
        self.browser.driver.switch_to.window(self.spare)
        self.open()

    @contextlib.contextmanager
    def frozen(self):
        self.page.do("Page.setWebLifecycleState", state="frozen")
        yield
        self.browser.driver.close()  # a page without a screen stays hidden after it was frozen
        self.browser.driver.switch_to.window(self.spare)
        self.open()

    @contextlib.contextmanager
    def suspended(self):
        """All of the browser stands still, as on a machine that sleeps."""
        browser = processes_below(self.browser.service.process.pid)
        for pid in browser:
            os.kill(pid, signal.SIGSTOP)
        yield
        for pid in browser:
            os.kill(pid, signal.SIGCONT)

    @contextlib.contextmanager
    def busy(self):
        self.page.script("setTimeout(() => {"
                         "const end = performance.now() + 2000; while (performance.now() < end); })")
        yield

    @contextlib.contextmanager
    def cut(self):
        self.proxy.cut()
        yield

    @contextlib.contextmanager
    def held(self):
        self.proxy.hold()
        yield

    @contextlib.contextmanager
    def hidden(self):
        with self.browser.tab_in_front():
            yield

    @contextlib.contextmanager
    def mouse(self):
        self.page.mouse("Pressed", self.stop_px)
        yield
        self.page.mouse("Released", self.stop_px)

    @contextlib.contextmanager
    def space(self):
        self.page.key("Down", "Space")
        yield
        self.page.key("Up", "Space")

    @contextlib.contextmanager
    def escape(self):
        self.page.key("Down", "Escape")
        yield
        self.page.key("Up", "Escape")

    @contextlib.contextmanager
    def touch(self):
        self.page.do("Input.dispatchTouchEvent", type="touchStart", touchPoints=[self.stop_px])
        yield
        self.page.do("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    @property
    def stop_px(self):
        x, y = self.page.script("const box = document.getElementById('stop').getBoundingClientRect();"
                                "return [box.left + box.width / 2, box.top + box.height / 2];")
        return {"x": x, "y": y}

    def pressed_s(self):
        """When the page's input came into being, on our clock."""
        return self.page.script("return window.pressed_ms") / 1e3 - time.time() + time.monotonic()

    def meet(self, fault, reason, within_s, since=None):
        """Milliseconds from a fault in mid-run, or from what `since` says, until the coils are off; the page
        that comes back says why."""
        self.page.ready().drive()
        count = len(self.console.events())
        fault_s = time.monotonic()
        with fault(self):
            happened_s = time.monotonic()
            since_s = since(self) if since else fault_s
            try:
                took_ms = self.watcher.stopped(self.console, count, since_s, within_s, reason)
            except AssertionError as error:
                error.add_note(f"the fault itself took {1e3 * (happened_s - fault_s):.0f} ms to happen")
                raise
        self.page.shows_stop(reason, 20.0)
        return took_ms


kPressed = {Operator.mouse: "(button)", Operator.space: "(space)", Operator.escape: "(escape)",
            Operator.touch: "(touch)"}
kStops = {fault.__name__: (fault, said, kPressedWithin_s, Operator.pressed_s)
          for fault, said in kPressed.items()}
kReasons = {Operator.killed: kSilent, Operator.closed: kGone, Operator.frozen: kGone, Operator.suspended: kSilent,
            Operator.busy: kSilent, Operator.cut: kSilent, Operator.held: kSilent, Operator.hidden: kHidden}
kFaults = {fault.__name__: (fault, said, kFaultWithin_s) for fault, said in kReasons.items()}
