"""What stands in a page of the documentation: its blocks, their commands, and the commands within its text."""
import dataclasses
import re


@dataclasses.dataclass(frozen=True)
class Place:
    """A piece of a page, as it is written there."""
    page: str
    line: int  # of its first line
    text: str

    def __str__(self):
        return f"{self.page}:{self.line}"


@dataclasses.dataclass(frozen=True)
class Block(Place):
    """A fenced block, or lines that are indented by four blanks."""
    language: str  # "": none is named

    def commands(self):
        """Its lines as a shell takes them: one that ends with a backslash goes on in the next."""
        found, pending = [], []
        for number, line in enumerate(self.text.splitlines(), self.line):
            pending.append(line)
            if line.endswith("\\"):
                continue
            text = "\n".join(pending)
            if text.strip() and not text.lstrip().startswith("#"):
                found.append(Place(self.page, number - len(pending) + 1, text))
            pending = []
        return found


def read(page, text):
    """The blocks of a page, and what is left of it: its lines, empty where a block stands."""
    blocks, left = [], []
    lines = text.splitlines()
    at = 0
    while at < len(lines):
        begin = at
        if lines[at].startswith("```"):
            at += 1
            while lines[at] != "```":
                at += 1
            blocks.append(Block(page, begin + 2, "\n".join(lines[begin + 1:at]), lines[begin][3:].strip()))
            at += 1
        elif lines[at].startswith("    ") and (at == 0 or not lines[at - 1].strip()):
            while at < len(lines) and lines[at].startswith("    "):
                at += 1
            blocks.append(Block(page, begin + 1, "\n".join(line[4:] for line in lines[begin:at]), ""))
        else:
            left.append(lines[at])
            at += 1
            continue
        left += [""] * (at - begin)
    return blocks, left


def commands_in_text(page, left, verbs):
    """Pieces of code within the text that are one of the verbs with an option, with or without the program's name, or a test program with
    the name of a test."""
    found = []
    for number, line in enumerate(left, 1):
        for code in re.findall(r"`([^`]+)`", line):
            words = re.sub(r"^(build/release/apps/)?lodestone ", "", code)
            if re.match(r'test_\w+ "', words) or " --" in words and any(words.startswith(verb + " ") for verb in verbs):
                found.append(Place(page, number, words))
    return found
