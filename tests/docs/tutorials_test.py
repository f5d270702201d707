"""Every command of README.md and docs/*.md, run as it is written there, page by page, in a checkout of this tree.

scripts/test shortens what takes long, by words behind those of the page (shorter.py); scripts/soak shortens nothing. What is not run
stands in listed.py, with its reason; the program parses it all the same.

usage: tutorials_test.py SOURCE BUILD PYTHON_PACKAGES
"""
import contextlib
import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "apps"))

import slurm_cluster  # noqa: E402
import soak  # noqa: E402

import listed  # noqa: E402
import pages  # noqa: E402
import reader  # noqa: E402
import shorter  # noqa: E402
from checkout import Checkout  # noqa: E402
from tutorials import Tutorials, cpu_s  # noqa: E402

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


def keep_quickstart(page, checkout, kept):
    """README.md's own run is what other pages go on from."""
    if page == "README.md" and (checkout.root / "runs/quickstart").is_dir():
        shutil.copytree(checkout.root / "runs/quickstart", kept / "quickstart")


def main(source, build, python_packages):
    texts = {str(file.relative_to(source)): file.read_text() for file in [source / "README.md", *sorted((source / "docs").glob("*.md"))]}
    with tempfile.TemporaryDirectory(prefix="lodestone-docs-") as name:
        folder = pathlib.Path(name)
        kept = folder / "kept"
        kept.mkdir()
        checkout = Checkout(folder, source, build, python_packages, soak.whole)
        tables = listed.tables()
        tutorials = Tutorials(checkout, tables, kept, LIMIT_S)
        in_text = []
        for page, text in texts.items():
            with cluster_for(page, checkout):
                tutorials.page(page, text)
            keep_quickstart(page, checkout, kept)
            in_text += pages.commands_in_text(page, pages.read(page, text)[1], tutorials.verbs)
        checkout.begin("")
        shutil.copy(checkout.root / "configs/rigs/paper.json", checkout.root / "rig.json")
        before = cpu_s()
        tutorials.text(soak.sample(in_text, IN_TEXT))
        print(f"{cpu_s() - before:7.1f} s of a processor: commands within the text", flush=True)
    faults = tutorials.faults + reader.faults(texts) + ([] if soak.whole else shorter.faults())
    for table in tables.values():
        faults += table.faults()
    print("\n".join(faults))
    soak.told(tutorials.run_count, f"commands and pieces of code of {len(texts)} pages run, {tutorials.parsed_count} more parsed, "
                                   f"{tutorials.unread_count} left to others; {cpu_s():.0f} s of a processor")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main(*(pathlib.Path(argument).resolve() for argument in sys.argv[1:4]))
