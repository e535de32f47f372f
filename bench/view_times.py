#!/usr/bin/env python3
"""How soon the live view answers: first light, a dimmed lamp, a moved object.

    bench/view_times.py SCENE [NODE]     NODE: name of what is moved (default: the first)
"""

import array
import json
import os
import struct
import subprocess
import sys
import time
import urllib.request

PROGRAM = os.environ.get("HALFLIGHT", "build/release/bin/halflight")
WATCHED = 3.0  # seconds after a move


class View:
    def __init__(self, scene):
        self.start = time.monotonic()
        self.process = subprocess.Popen([PROGRAM, "view", scene], stdout=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()

    def get(self, path):
        with urllib.request.urlopen(self.url + path, timeout=60) as answer:
            return answer.read()

    def status(self):
        return json.loads(self.get("api/status"))

    def control(self, command):
        body = json.dumps(command).encode()
        request = urllib.request.Request(self.url + "api/control", data=body, method="POST")
        urllib.request.urlopen(request, timeout=60).read()

    def light(self):
        packet = self.get("api/light?epoch=0&since=0")
        length = struct.unpack("<I", packet[4:8])[0]
        return json.loads(packet[8:8 + length]), packet[8 + length:]

    def wait(self, condition):
        while not condition(status := self.status()):
            if status["phase"] == "failed":
                sys.exit(status["sentence"])
            time.sleep(0.002)
        return status


def brightness(header, data):
    """Square root of the irradiance at each vertex, about as bright as it looks."""
    start, size = (header["arrays"]["light"][k] for k in ("offset", "count"))
    values = array.array("I", data[start:start + 4 * size])
    scale = header["scale"] / 3
    return [(scale * ((v & 511) + (v >> 9 & 511) + (v >> 18 & 511)) * 2.0 ** ((v >> 27) - 24)) ** 0.5
            for v in values]


def main():
    view = View(sys.argv[1])
    try:
        view.wait(lambda s: s["version"] > 0)
        print(f"first light     {time.monotonic() - view.start:.3f} s")
        done = view.wait(lambda s: s["phase"] == "done")
        print(f"done and sharp  {time.monotonic() - view.start:.1f} s")

        begin = time.monotonic()
        view.control({"groups": {done["groups"][0]["name"]: 0.5}})
        view.wait(lambda s: s["version"] > done["version"])
        print(f"lamp dimmed     {time.monotonic() - begin:.3f} s")
        view.control({"groups": {done["groups"][0]["name"]: 1}})
        before = view.wait(lambda s: s["phase"] == "done")

        topology = view.get("api/topology")
        nodes = json.loads(topology[8:8 + struct.unpack("<I", topology[4:8])[0]])["nodes"]
        wanted = sys.argv[2] if len(sys.argv) > 2 else nodes[0]["name"]
        node = next(n for n in nodes if n["name"] == wanted)
        begin = time.monotonic()
        view.control({"node": node["id"], "offset": [0.1, 0, 0.1]})
        seen = view.wait(lambda s: s["version"] > before["version"])
        print(f"'{wanted}' moved, seen in its old light  {time.monotonic() - begin:.3f} s")
        view.wait(lambda s: s["version"] > seen["version"] and s["iterations"] < before["iterations"])
        print(f"'{wanted}' moved, seen in new light      {time.monotonic() - begin:.3f} s")
        frames = []
        while time.monotonic() - begin < WATCHED:
            header, packet = view.light()
            if not frames or header["version"] > frames[-1][1]["version"]:
                frames.append((time.monotonic() - begin, header, packet))
            time.sleep(0.01)
        epoch = frames[0][1]["epoch"]  # the sharp picture later has other vertices
        frames = [(t, brightness(h, p)) for t, h, p in frames if h["epoch"] == epoch]
        old, new = frames[0][1], frames[-1][1]
        change = [b - a for a, b in zip(old, new)]
        length = sum(c * c for c in change)
        shares = [(t, sum((v - a) * c for v, a, c in zip(f, old, change)) / length) for t, f in frames]
        for t, share in shares:
            print(f"  {t:.2f} s: {100 * share:.0f} % of the change")
        near = next(t for i, (t, _) in enumerate(shares) if all(0.9 < s < 1.1 for _, s in shares[i:]))
        print(f"90 % of the change, and no more than 110 %, from {near:.2f} s on")
    finally:
        view.process.terminate()
        view.process.wait()


if __name__ == "__main__":
    main()
