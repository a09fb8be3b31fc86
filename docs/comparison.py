#!/usr/bin/env python3
"""Measures what the book's page `comparison.md` shows, by the scripts that compare with peers, and writes it there.
The part `follow` is the table of the page `quick-start.md`.

    python3 docs/comparison.py                       # all parts; hours, 8 GB and a quiet machine
    python3 docs/comparison.py solver robots         # these parts; the others stay as they are
    python3 docs/comparison.py --keep FOLDER …       # keeps what is installed, and uses it again

Of each part the page has the command, the machine, the date and how busy the machine was. Peers come from PyPI.
"""

import argparse
import datetime
import os
import pathlib
import platform
import re
import subprocess
import tempfile
import venv

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/src/comparison.md"
QUICK_START = ROOT / "docs/src/quick-start.md"
IK = "moca-model/whole-body/benches/peers/ik.py"


def solver(folder, more):
    return ["python3", "ahqp-core/benches/peers/run.py", "--keep", folder / "solver", *more]


def robots(folder, more):
    return ["python3", "moca-model/whole-body/benches/peers/run.py", "--venv", folder / "robots", *more]


def inverse_kinematics(folder, more):
    # Placo needs an older Pinocchio than Pink.
    first = environment(folder / "ik", ["pin-pink", "mink", "quadprog", "daqp"])
    second = environment(folder / "placo", ["placo"])
    return [first, IK, second, *more]


def vision(folder, more):
    os.environ["PEERS"] = str(folder / "vision")
    return ["vision-models/benches/peers/run.sh", *more]


def scores(_folder, _more):
    return ["cargo", "test", "--package", "ergo-map", "--test", "it", "--", "reba::", "rula::"]


def follow(_folder, _more):
    return ["cargo", "run", "--quiet", "--release", "-p", "examples", "--bin", "follow", "--", "--no-report", "--quiet"]


PARTS = {
    "solver": solver, "robots": robots, "inverse-kinematics": inverse_kinematics, "vision": vision, "scores": scores,
    "follow": follow,
}


def environment(folder, packages):
    """The interpreter of a virtual environment with these packages."""
    python = folder / "bin/python"
    if not python.exists():
        venv.create(folder, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", *packages], check=True)
    return python


def machine():
    """Processor, cores and system."""
    cpu = platform.processor()
    info = pathlib.Path("/proc/cpuinfo")
    if info.exists() and (found := re.search(r"model name\s*: (.*)", info.read_text())):
        cpu = found[1]
    return f"{cpu}, {os.cpu_count()} cores, {platform.system()}"


def write_block(page, name, text):
    """Replaces what is between the marks of this name on a page."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->"
    head, rest = page.read_text().split(begin)
    _, tail = rest.split(end)
    page.write_text(f"{head}{begin}\n{text}\n{end}{tail}")


def measure(name, folder, more):
    """The text between the page's marks of this part."""
    command = [str(word) for word in PARTS[name](folder, more)]
    before = os.getloadavg()[0]
    output = subprocess.run(command, cwd=ROOT, check=True, text=True, stdout=subprocess.PIPE).stdout
    if name == "follow":
        # Only the rows that are the same in every run.
        rows, times, _ = output.partition("\ntick, ")
        return f"```text\n{rows if times else output}\n…\n```\n"
    load = f"load {before:.1f} before and {os.getloadavg()[0]:.1f} after"
    # Of the compiler's words and of folders that are gone nothing.
    printed = " ".join(command).replace(f"{folder}/", "FOLDER/")
    lines = [line.rstrip() for line in output.splitlines() if not line.lstrip().startswith(("Compiling", "Finished", "Running"))]
    date = datetime.date.today().isoformat()
    return f"`{printed}`, {date}, {machine()}, {load}:\n\n```text\n" + "\n".join(lines).strip("\n") + "\n```\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", choices=[[], *PARTS], metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--keep", type=pathlib.Path, help="folder of what is installed")
    parser.add_argument("--options", default="", help="further options of the parts' own scripts, such as --options='--limit 100'")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = (arguments.keep or pathlib.Path(scratch)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        for name in arguments.parts or PARTS:
            text = measure(name, folder, arguments.options.split())
            place = QUICK_START if name == "follow" else PAGE
            write_block(place, name, text)
            print(f"{name}: done")


if __name__ == "__main__":
    main()
