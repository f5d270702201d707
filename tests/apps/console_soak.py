"""The console for hours: faults in the operator's browser, at random, one a minute; the coils go off in time
each time, no current flows while nothing runs, nothing on record is lost, and the memory stays.
usage: console_soak.py PROGRAM [MINUTES]"""
import random
import sys
import tempfile
import threading
import time

import soak
from console_faults import Operator, kFaults, kStops

kEvery_s = 60.0
kSettled = 4        # faults, until the memory is that of every later one
kMoreMemory_MB = 20.0


class Stalls:
    """How long this machine let nobody's thread run at most, so that what was late can be told from what stood still."""

    def __init__(self):
        self.longest_ms = 0.0
        threading.Thread(target=self.look, daemon=True).start()

    def look(self):
        last_s = time.monotonic()
        while True:
            time.sleep(0.02)
            now_s = time.monotonic()
            self.longest_ms, last_s = max(self.longest_ms, 1e3 * (now_s - last_s - 0.02)), now_s

    def since_last(self):
        longest_ms, self.longest_ms = self.longest_ms, 0.0
        return longest_ms


program = sys.argv[1]
minutes = float(sys.argv[2]) if len(sys.argv) > 2 else 120.0 if soak.whole else 0.3
every_s = min(kEvery_s, 60.0 * minutes / (2 * kSettled))
draw = random.Random(soak.seed)
faults = {**kFaults, **kStops}
worst_ms, memory_MB, met = dict.fromkeys(faults, 0.0), [], []
stalls, longest_stall_ms = Stalls(), 0.0

with tempfile.TemporaryDirectory() as folder, Operator(program, f"{folder}/console", "--virtual") as operator:
    begun_s = time.monotonic()
    while time.monotonic() - begun_s < 60.0 * minutes:
        next_s = time.monotonic() + every_s
        name = draw.choice(list(faults))
        longest_stall_ms = max(longest_stall_ms, stalls.since_last())
        try:
            worst_ms[name] = max(worst_ms[name], operator.meet(*faults[name]))
        except AssertionError as error:
            error.add_note(f"fault {len(met) + 1} ({name}); meanwhile no thread ran for {stalls.since_last():.0f} ms")
            raise
        met.append(faults[name][1])
        operator.watcher.check_off(operator.console.events())
        memory_MB.append(operator.console.memory_MB())
        while (left_s := next_s - time.monotonic()) > 0.0:
            operator.page.ready().drive()
            time.sleep(min(left_s, 5.0))
        if len(memory_MB) > kSettled:
            grown_MB = memory_MB[-1] - memory_MB[kSettled - 1]
            assert grown_MB < kMoreMemory_MB, f"{grown_MB:.1f} MB more memory: {memory_MB}"
    longest_stall_ms = max(longest_stall_ms, stalls.since_last())
    events = operator.console.events()
    stops = iter(event["text"] for event in events if event["level"] == "stop")
    assert all(any(said in stop for stop in stops) for said in met), f"not all on record: {met}, {events}"
    unasked = sum(event["level"] == "stop" for event in events) - len(met)
    times_s = [event["time_s"] for event in events]
    assert times_s == sorted(times_s), "the record is out of order"

grown_MB = memory_MB[-1] - memory_MB[min(kSettled, len(memory_MB)) - 1]
found = ", ".join(f"{name} {worst:.0f} ms" for name, worst in worst_ms.items() if worst)
print(f"memory {memory_MB[-1]:.0f} MB, {grown_MB:+.1f} MB since fault {kSettled}; "
      f"{unasked} stops of pages that were too slow; no thread ran for {longest_stall_ms:.0f} ms at most; {found}")
soak.told(len(met), f"faults of an operator's browser in {minutes:.0f} minutes, "
                    f"off after at most {max(worst_ms.values()):.0f} ms")
