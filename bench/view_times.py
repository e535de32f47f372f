#!/usr/bin/env python3
"""How soon the live view answers: first light, a dimmed lamp, a moved object.

    bench/view_times.py SCENE [NODE]     NODE: name of what is moved (default: the first)
"""

import json
import struct
import subprocess
import sys
import time
import urllib.request

PROGRAM = "build/release/bin/halflight"
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

    def wait(self, condition):
        while not condition(status := self.status()):
            if status["phase"] == "failed":
                sys.exit(status["sentence"])
            time.sleep(0.002)
        return status


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
        means = []
        while time.monotonic() - begin < WATCHED:
            s = view.status()
            means.append((time.monotonic() - begin, s["meanIrradiance"]))
            time.sleep(0.02)
        last = means[-1][1]
        near = next(t for i, (t, _) in enumerate(means)
                    if all(abs(m - last) < 0.1 * last for _, m in means[i:]))
        print(f"mean irradiance within 10 % of what it is after {WATCHED:g} s from {near:.2f} s on")
    finally:
        view.process.terminate()
        view.process.wait()


if __name__ == "__main__":
    main()
