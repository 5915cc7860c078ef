"""Records what the reference implementation makes of the programs in ``data/reference/table.json``.

Run as ``python -m tests.record_table --python PATH``, where PATH is the Python of an environment with the reference. All programs
run in one process of it, each in a fork of its own, since a failure leaves state behind there.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

FILE = Path(__file__).parent / "data" / "reference" / "table.json"

DRIVER = """
import json, os, random, sys, warnings
warnings.simplefilter("ignore")
import numpy
from scenic.syntax.translator import scenarioFromString

def observed(value):
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    try:
        return float(value)
    except (TypeError, ValueError):
        pass
    if isinstance(value, dict):
        return {str(key): observed(item) for key, item in value.items()}
    if hasattr(value, "eulerAngles"):
        sign = 1 if value.w >= 0 else -1
        return {"q": [sign * float(part) for part in (value.x, value.y, value.z, value.w)]}
    if hasattr(value, "position") and hasattr(value, "orientation"):
        return {"position": observed(value.position), "orientation": observed(value.orientation)}
    try:
        return [observed(item) for item in value]
    except TypeError:
        return type(value).__name__

def run(text, scenes):
    random.seed(0)
    numpy.random.seed(0)
    try:
        scenario = scenarioFromString(text)
        rows = [observed(scenario.generate()[0].params) for _ in range(scenes)]
        return {"params": rows if scenes > 1 else rows[0]}
    except BaseException as error:
        name = type(error).__name__
        return {"error": {"ScenicParseError": "ScenicSyntaxError"}.get(name, name)}

data = json.load(open(sys.argv[1]))
for name, entry in data["programs"].items():
    reader, writer = os.pipe()
    if os.fork() == 0:
        os.close(reader)
        text = entry["program"].replace("{SETTING}", data["setting"])
        with os.fdopen(writer, "w") as stream:
            json.dump(run(text, entry.get("scenes", 1)), stream)
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as stream:
        result = stream.read()
    os.wait()
    print(json.dumps([name, json.loads(result)]), flush=True)
"""
"""Runs in the reference's environment; prints the result of each program as a line of JSON."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", required=True, help="the Python of an environment with the reference")
    options = parser.parse_args()
    data = json.loads(FILE.read_text())
    with tempfile.TemporaryDirectory() as folder:
        driver = Path(folder) / "driver.py"
        driver.write_text(DRIVER)
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        done = subprocess.run(
            [options.python, str(driver), str(FILE)],
            capture_output=True,
            text=True,
            check=True,
            cwd=folder,
            env=environment,
        )
    for line in done.stdout.splitlines():
        if line.startswith('["'):
            name, result = json.loads(line)
            entry = data["programs"][name]
            for key in ("params", "error"):
                entry.pop(key, None)
            entry.update(result)
    text = json.dumps(data, separators=(",", ":")).replace('},"', '},\n"')
    FILE.write_text(text + "\n")


if __name__ == "__main__":
    main()
