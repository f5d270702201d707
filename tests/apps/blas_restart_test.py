"""The program starts itself again, once, where OpenBLAS did not know the processor's AVX-512 or AVX2."""
import os
import subprocess
import sys

program, old_openblas = sys.argv[1:]
flags = set(open("/proc/cpuinfo").read().split("flags", 1)[-1].split("\n", 1)[0].split())
has_avx512 = {"avx512f", "avx512bw", "avx512dq", "avx512vl"} <= flags
failures = []


def check(restarts, arguments=(), chosen="Haswell", **environment):
    clean = {key: value for key, value in os.environ.items() if key != "OPENBLAS_CORETYPE"}
    made = subprocess.run([program, *arguments, "config", "--print", "bench", "speed"], capture_output=True, text=True,
                          env={**clean, **environment, "CHOSEN_CORE": chosen, "LD_PRELOAD": old_openblas}, timeout=120)
    if made.returncode != 0 or "meaning" not in made.stdout:
        failures.append(f"{arguments} {chosen} {environment}: exit {made.returncode}, {made.stdout!r} {made.stderr!r}")
    if made.stderr.count("starting again") != restarts:
        failures.append(f"{arguments} {chosen} {environment}: expected {restarts} restarts, stderr {made.stderr!r}")


check(1 if has_avx512 else 0)
check(1 if has_avx512 or {"avx2", "fma"} <= flags else 0, chosen="Prescott")
check(0, chosen="SkylakeX")
check(0, arguments=["--no-reexec"])
check(0, OPENBLAS_CORETYPE="Haswell")  # the user's choice stands
sys.exit("\n".join(failures) or 0)
