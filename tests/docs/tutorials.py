"""Goes through pages as their reader would, and tells what does not work."""
import re
import shlex
import subprocess
import time
import urllib.request

import listed
import pages
import reader
import shorter

SHELL = ("", "sh", "bash", "console")
PROGRAMS = ("lodestone", "build/release/apps/lodestone")


def words_of_program(text):
    """What a line gives to the program, as written; nothing where it does not call it."""
    words = shlex.split(text, comments=True)
    if words[:1] == ["time"]:
        del words[0]
    return words[1:] if words and words[0] in PROGRAMS else []


def answers(printed):
    """Whether the console serves its page at the address that it has printed."""
    url = next((line for line in printed.splitlines() if line.startswith("http://")), None)
    if url is None:
        return False
    try:
        with urllib.request.urlopen(url, timeout=30) as page:
            return b"STOP" in page.read()
    except OSError:
        return False


def runs_until_ctrl_c(printed):
    return "it runs until Ctrl-C" in printed


# What goes on until Ctrl-C, and when it is ready. The reader's next command is given in another terminal.
# Where the text between two blocks says Ctrl-C, they are ended, and else at the end of the page.
SERVERS = {"console": answers, "rig emulate": runs_until_ctrl_c}


class Tutorials:
    def __init__(self, checkout, tables, kept, limit_s):
        self.checkout, self.tables, self.kept, self.limit_s = checkout, tables, kept, limit_s
        self.faults, self.run_count, self.parsed_count, self.unread_count = [], 0, 0, 0
        made = self.program("config", "--print", "nothing")
        self.verbs = made.stderr.rpartition("with a configuration are ")[2].strip().split(", ")

    def program(self, *words):
        return subprocess.run([self.checkout.program, "--no-reexec", *words], cwd=self.checkout.root, env=self.checkout.environment,
                              capture_output=True, text=True)

    def told(self, began_s, what):
        print(f"{time.monotonic() - began_s:7.1f} s  {what}", flush=True)

    def fault(self, place, what):
        if what:
            self.faults.append(f"{place}: {place.text.splitlines()[0]}\n    {what}".rstrip())

    def parse(self, place, words):
        """The program reads the words as it would for a run: options, presets, keys, values."""
        self.parsed_count += 1
        words = [word.replace("/usr/share/lodestone/", "") for word in words]
        if not any(words[:len(verb.split())] == verb.split() for verb in self.verbs):
            return self.fault(place, "cannot be parsed without being run; run it")
        made = self.program("config", "--print", *words)
        self.fault(place, "" if made.returncode == 0 else made.stderr.strip())

    def list_tests(self, place, text):
        """A test program's cases that a line names."""
        self.parsed_count += 1
        self.fault(place, self.checkout.run(f"({text} --list-tests || true) | grep -E '^[1-9][0-9]* matching test case'", self.limit_s))

    def leave_out(self, place):
        """A command that is listed: what can be said without running it."""
        words = words_of_program(place.text)
        if words:
            return self.parse(place, words)
        program = shlex.split(place.text, comments=True)[0]
        if program.startswith("build/dev/tests/"):
            return self.list_tests(place, place.text)
        self.unread_count += 1
        if program.startswith("scripts/"):
            self.fault(place, self.checkout.run(f"bash -n {program} && test -x {program}", self.limit_s))
        for file in re.findall(r"build/release/[\w./-]+", place.text):
            if not file.endswith(".deb") and not (self.checkout.root / file).is_file():
                self.fault(place, f"there is no {file}")

    def command(self, place):
        if self.tables["NOT_RUN"].look_up(place):
            return self.leave_out(place)
        if self.tables["SOAK_ONLY"].look_up(place) and not self.checkout.whole:
            return self.leave_out(place)
        text = place.text
        if more := self.tables["ON_THE_VIRTUAL_RIG"].look_up(place):
            text += " " + more
        words = words_of_program(text)
        if shorter.hides(shorter.shortened(place.page, words)) and not self.checkout.whole:
            self.parse(place, words)
        server = next((ready for verb, ready in SERVERS.items() if words[:len(verb.split())] == verb.split()), None)
        self.run_count += 1
        began_s = time.monotonic()
        self.fault(place, self.checkout.serve(text, server, 60) if server else self.checkout.run(text, self.limit_s))
        if words[:1] == ["console"]:
            self.fault(place, self.checkout.end_servers())
        self.told(began_s, f"{place}  {place.text[:100]}")

    def code(self, block, language, before=""):
        """A block of code as a file of its own, outside the checkout."""
        text = block.text if self.checkout.whole else shorter.code(block.page, block.text)
        file = self.checkout.home / ("block.py" if language == "python" else "block.c")
        if language == "python":
            file.write_text(before + text + "\n")
            line = f"/usr/bin/python3 {file}"
        else:  # declarations and statements, behind what they include
            includes = [each for each in text.splitlines() if each.startswith("#include")]
            rest = "\n".join(each for each in text.splitlines() if each not in includes)
            file.write_text("\n".join(includes) + "\nint main(void) {\n" + rest + "\nreturn 0;\n}\n")
            line = f"gcc -std=c99 -Wall -Wextra -I. {file} -lm -o {file}.out && {file}.out"
        self.run_count += 1
        began_s = time.monotonic()
        self.fault(block, self.checkout.run(line, self.limit_s))
        self.told(began_s, f"{block}  {language}")

    def block(self, block):
        if self.tables["NO_COMMANDS"].look_up(block):
            return
        if name := self.tables["FILES"].look_up(block):
            text = block.text if self.checkout.whole else shorter.file(name, block.text)
            (self.checkout.root / name).write_text(text + "\n")
        elif block.language in SHELL:
            for each in block.commands():
                self.command(each)
        elif block.language == "python" and self.tables["NOT_RUN"].look_up(block):
            self.unread_count += 1
            try:
                compile(block.text, str(block), "exec")
            except SyntaxError as error:
                self.fault(block, str(error))
        elif block.language in ("python", "c"):
            before = next((text for (page, begin), text in reader.BEFORE_CODE.items() if page == block.page and block.text.startswith(begin)), "")
            self.code(block, block.language, before)
        else:
            self.fault(block, f"no test knows what to do with {block.language}: say in tests/docs/listed.py what it is")

    def page(self, page, text):
        """Everything of a page, from its first line to its last."""
        blocks, left = pages.read(page, text)
        if not blocks:
            return
        self.checkout.begin(page)
        began_s = time.monotonic()
        try:
            for has in reader.HAS.get(page, ()):
                has(self.checkout, self.kept)
        except (OSError, subprocess.CalledProcessError) as error:
            return self.fault(blocks[0], f"what its reader has cannot be made: {error} {getattr(error, 'stderr', '')}")
        try:
            said_to = 0  # what is before this line has been read
            for each in blocks:
                if any("Ctrl-C" in line for line in left[said_to:each.line]):
                    self.fault(each, self.checkout.end_servers())
                self.block(each)
                said_to = each.line
        finally:
            self.fault(blocks[-1], self.checkout.end_servers())
        self.told(began_s, f"in all: {page}")

    def text(self, found):
        """Commands within the text of pages: parsed, with something in the place of the reader's own words."""
        for place in found:
            if test := re.match(r"test_(\w+) ", place.text):
                self.list_tests(place, f"build/dev/tests/{test[1]}/{place.text}")
                continue
            words = [listed.READERS_OWN.get(word, word) for word in shlex.split(place.text.partition(";")[0])]
            words = [f"{key}={listed.READERS_OWN[value]}" if value in listed.READERS_OWN else word
                     for word in words for key, _, value in [word.partition("=")]]
            self.parse(place, words)
