"""A driver outside the program, with Python's own library alone: the coil controller on a serial port, a real or an
emulated one. In rig.json: "backend": "driver", "driver": {"coils": "process:python3 examples/driver_coils.py PORT"}"""
import json, os, random, select, struct, sys, termios, tty, zlib

HELLO, CONFIGURE, PULSE, STOP, STATUS, CLEAR, PING = range(1, 8)  # docs/serial-protocol.md
line, number = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY), random.randrange(65536)
tty.setraw(line)
termios.tcsetattr(line, 0, termios.tcgetattr(line)[:4] + [termios.B115200] * 2 + termios.tcgetattr(line)[6:])

def receive(within_s):
    stuffed, message = b"", b""
    while select.select([line], [], [], within_s)[0]:
        byte = os.read(line, 1)
        stuffed += byte.strip(b"\0")
        if byte == b"\0" and stuffed:
            while stuffed:
                message, stuffed = message + stuffed[1:stuffed[0]] + b"\0", stuffed[stuffed[0]:]
            return message[:-5] if struct.pack("<I", zlib.crc32(message[:-5])) == message[-5:-1] else b""

def ask(kind, body=b""):
    global number
    number = (number + (kind != STOP)) % 65536  # a stop stands outside the order
    message = struct.pack("<BH", kind, number) + body
    parts = (message + struct.pack("<I", zlib.crc32(message))).split(b"\0")
    for _ in range(40 if kind == HELLO else 4):  # opening the port may have restarted it
        os.write(line, b"\0" + b"".join(bytes([len(part) + 1]) + part for part in parts) + b"\0")
        while (reply := receive(0.05)) is not None:
            if reply[:3] == struct.pack("<BH", kind | 0x80, number):
                return reply[3:]
            if reply[:4] == struct.pack("<BHB", 0xff, number, kind):
                raise ValueError("the coil controller: reason %d, detail %d" % struct.unpack("<BH", reply[4:7]))
    raise OSError("the coil controller does not answer")

def answer(asked):
    if asked["do"] == "hello":
        coils, ohm = asked["coils"], [coil["resistance_20C_ohm"] for coil in asked["coils"]]
        names, most_A = [coil["name"] for coil in coils], max(max(coil["largest_A"], -coil["smallest_A"]) for coil in coils)
        opposite = [names.index((coil["not_with"] or [coil["name"]])[0]) for coil in coils]
        ask(HELLO, struct.pack("<BI", 2, random.getrandbits(32)))
        limits = [1e3 * most_A, 1e3 * asked["max_pulse_s"], 600, 10000, 200, 800, *(1e3 * each for each in ohm)]
        ask(CONFIGURE, struct.pack("<11H4BH", *map(round, limits + [3 * most_A ** 2 * max(ohm)]), *opposite, 1400))
        while not ask(STATUS)[0] & 4: pass  # until the motor controllers are ready
        return {"protocol": 1, "name": "coil controller, by Python"}
    if asked["do"] == "status":
        state = struct.unpack("<BHIHH4h4H2h2HH", ask(STATUS))
        return {"current_A": [1e-3 * current for current in state[5:9]], "supply_V": 0.1 * min(state[15:17]),
                "faults": ["number %d of docs/serial-protocol.md" % bit for bit in range(12) if state[1] >> bit & 1]}
    if asked["do"] == "pulse":
        return ask(PULSE, struct.pack("<4hH", *(round(1e3 * each) for each in [*asked["current_A"], asked["duration_s"]]))) and {}
    return ask({"stop": STOP, "clear": CLEAR, "ping": PING}[asked["do"]]) and {}

while len(head := sys.stdin.buffer.read(4)) == 4:  # until the program has gone
    asked = json.loads(sys.stdin.buffer.read(int.from_bytes(head, "little")))
    try:
        text = json.dumps({"id": asked["id"], **(answer(asked) or {})}).encode()
    except Exception as error:
        text = json.dumps({"id": asked["id"], "error": repr(error)}).encode()
    os.write(1, len(text).to_bytes(4, "little") + text)
ask(STOP)
