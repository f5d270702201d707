"""Long checks: scripts/test takes a seeded sample of them, scripts/soak (LODESTONE_SOAK=1) the whole. As tests/soak.h."""
import os
import random

whole = "LODESTONE_SOAK" in os.environ
seed = int(os.environ.get("LODESTONE_SOAK_SEED", "1"))


def sample(items, count):
    """All of the items in a soak, else `count` of them, drawn by the seed, in their order."""
    items = list(items)
    if whole or len(items) <= count:
        return items
    return [items[i] for i in sorted(random.Random(seed).sample(range(len(items)), count))]


def told(count, what):
    """The line that scripts/soak collects."""
    print(f"soak: {count} {what}, seed {seed}", flush=True)
