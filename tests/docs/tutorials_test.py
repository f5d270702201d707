"""Every command of README.md and docs/*.md, run as it is written there, page by page, in a checkout of this tree.

scripts/test shortens what takes long (shorter.py), and goes through as many pages side by side as there are processors, but for those
that need a clock; scripts/soak does neither. What is not run stands in listed.py, with its reason; the program parses it all the same.

usage: tutorials_test.py SOURCE BUILD PYTHON_PACKAGES
"""
import contextlib
import os
import pathlib
import queue
import resource
import shutil
import sys
import tempfile
from concurrent import futures

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "apps"))

import slurm_cluster  # noqa: E402
import soak  # noqa: E402

import listed  # noqa: E402
import pages  # noqa: E402
import reader  # noqa: E402
import shorter  # noqa: E402
from checkout import Checkout  # noqa: E402
from tutorials import SERVERS, Tutorials  # noqa: E402

ON_A_CLUSTER = ("docs/scale.md",)
EIGHT_PROCESSORS = slurm_cluster.CONFIGURATION.replace("CPUs=2", "CPUs=8")  # as many as that page asks for
IN_TEXT = 8  # commands within the text that the sample has parsed
LIMIT_S = 86400 if soak.whole else 600  # of one command


@contextlib.contextmanager
def cluster_for(page, checkout):
    if page not in ON_A_CLUSTER:
        yield
        return
    slurm_cluster.CONFIGURATION = EIGHT_PROCESSORS
    with slurm_cluster.Cluster() as cluster:
        checkout.environment["SLURM_CONF"] = cluster.environment["SLURM_CONF"]
        yield
    del checkout.environment["SLURM_CONF"]


def on_a_clock(text):
    """Whether a page drives a bench while time goes on by itself: nothing goes on beside it."""
    return any(f"lodestone {verb}" in text for verb in SERVERS)


def read_page(tutorials, page, text):
    with cluster_for(page, tutorials.checkout):
        tutorials.page(page, text)


def side_by_side(readers, texts):
    """Each reader takes the next page as soon as it has come to the end of one."""
    left = queue.SimpleQueue()
    for page in texts.items():
        left.put(page)

    def read(tutorials):
        with contextlib.suppress(queue.Empty):
            while True:
                read_page(tutorials, *left.get_nowait())

    with futures.ThreadPoolExecutor(len(readers)) as pool:
        for each in [pool.submit(read, tutorials) for tutorials in readers]:
            each.result()  # or what was thrown


def main(source, build, python_packages):
    texts = {str(file.relative_to(source)): file.read_text() for file in [source / "README.md", *sorted((source / "docs").glob("*.md"))]}
    with tempfile.TemporaryDirectory(prefix="lodestone-docs-") as name:
        folder = pathlib.Path(name)
        kept = folder / "kept"
        kept.mkdir()
        tables = listed.tables()
        readers = [Tutorials(Checkout(folder / str(number), source, build, python_packages, soak.whole), tables, kept, LIMIT_S)
                   for number in range(1 if soak.whole else os.cpu_count())]  # what the pages say to build is built once
        first = readers[0]
        read_page(first, "README.md", texts["README.md"])
        made = first.checkout.root / "runs/quickstart"
        if made.is_dir():
            shutil.copytree(made, kept / "quickstart")  # other pages go on from it
        rest = {page: text for page, text in texts.items() if page != "README.md"}
        side_by_side(readers, {page: text for page, text in rest.items() if not on_a_clock(text)})
        side_by_side(readers[:1], {page: text for page, text in rest.items() if on_a_clock(text)})
        in_text = [each for page, text in texts.items() for each in pages.commands_in_text(page, pages.read(page, text)[1], first.verbs)]
        first.checkout.begin("")
        shutil.copy(first.checkout.root / "configs/rigs/paper.json", first.checkout.root / "rig.json")
        first.text(soak.sample(in_text, IN_TEXT))
    faults = [fault for each in readers for fault in each.faults] + reader.faults(texts) + ([] if soak.whole else shorter.faults())
    for table in tables.values():
        faults += table.faults()
    print("\n".join(faults))
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    run, parsed, unread = (sum(getattr(each, name) for each in readers) for name in ("run_count", "parsed_count", "unread_count"))
    soak.told(run, f"commands and pieces of code of {len(texts)} pages run, {parsed} more parsed, {unread} left to others; "
                   f"{used.ru_utime + used.ru_stime:.0f} s of a processor")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main(*(pathlib.Path(argument).resolve() for argument in sys.argv[1:4]))
