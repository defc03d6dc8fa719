"""`python -m touchline.season plan.json --parts PARTS`: the shards of a season's plan by Ray, a task each.

The plan is that of `touchline plan`; the frames lie at the same paths on every node. PARTS is a folder that all nodes see, or
`s3://…`, `gs://…` (`pip install touchline[season-cloud]`): a node then works in a folder of its own and uploads whole parts.
Shards whose part is there are not done again. Ray runs with tokens alone: `ray get-auth-token --generate` before `ray start`.
"""

import argparse
import hashlib
import importlib
import json
import os
import socket
import stat
import subprocess
import sys
import tempfile
import threading
import time
from typing import Any, Dict, List, Optional, Tuple

from .__main__ import program

# Ray reads these when it is imported.
os.environ["RAY_AUTH_MODE"] = "token"
os.environ["RAY_USAGE_STATS_ENABLED"] = "0"

HEAD_LOST_S, REPORT_S = 30, 10


class Killed(Exception):
    """The program was killed, by a lack of memory for instance: another try may end well."""


class Parts:
    """Where parts are kept: a folder that every node sees, or a place that pyarrow knows."""

    def __init__(self, place: str) -> None:
        self.remote: Any = None
        self.folder = os.path.abspath(place)
        if "://" in place:
            self.remote, self.folder = importlib.import_module("pyarrow.fs").FileSystem.from_uri(place)

    def has(self, shard: str) -> bool:
        path = f"{self.folder}/{shard}.part"
        return bool(self.remote.get_file_info(path).is_file) if self.remote else os.path.isfile(path)

    def fetch(self, shard: str, folder: str) -> None:
        here = os.path.join(folder, f"{shard}.part")
        # Written aside and renamed: other tasks of this node may read the part at the same time.
        if self.remote and not os.path.exists(here) and self.has(shard):
            with tempfile.NamedTemporaryFile(dir=folder, delete=False) as file:
                file.write(self.remote.open_input_file(f"{self.folder}/{shard}.part").readall())
            os.replace(file.name, here)

    def send(self, shard: str, folder: str) -> None:
        # An object store shows an object once it is whole.
        if self.remote:
            with open(os.path.join(folder, f"{shard}.part"), "rb") as file:
                with self.remote.open_output_stream(f"{self.folder}/{shard}.part") as part:
                    part.write(file.read())


def scratch_folder(plan: str) -> str:
    """The folder of this user for a plan, which the tasks of a node share; it is made if it is missing."""
    path = os.path.join(tempfile.gettempdir(), f"touchline-{os.getuid()}-{hashlib.sha256(plan.encode()).hexdigest()[:16]}")
    try:
        os.mkdir(path, 0o700)
    except FileExistsError:
        # Others know its name and may have made it, or a link there, to read the plan or to put files into it.
        there = os.lstat(path)
        if not stat.S_ISDIR(there.st_mode) or there.st_uid != os.getuid() or there.st_mode & 0o022:
            raise RuntimeError(f"{path} is not a folder of this user alone; remove it, or set TMPDIR to another folder") from None
    return path


def do_shard(plan: str, shard: str, place: str, touchline: Optional[str], found: Optional[Tuple[str, float]] = None) -> Tuple[str, float]:
    """Does a shard on this node; its name and its seconds. `found` is that of the shard that it needs: Ray waits for it."""
    begun, kept = time.time(), Parts(place)
    scratch = scratch_folder(plan)
    parts = os.path.join(scratch, "parts") if kept.remote else kept.folder
    os.makedirs(parts, exist_ok=True)
    with open(os.path.join(scratch, f"plan-{os.getpid()}.json"), "w") as file:
        file.write(plan)
    if found is not None:
        kept.fetch(found[0], parts)
    command = [touchline or program() or "touchline", "shard", file.name, shard, "-o", parts]
    # The program writes UTF-8 whatever the node's locale is, and a message must not fail the shard.
    ran = subprocess.run(command, stderr=subprocess.PIPE, encoding="utf-8", errors="replace")
    if ran.returncode < 0:
        raise Killed(f"{shard}: ended by signal {-ran.returncode}")
    if ran.returncode:
        raise RuntimeError((ran.stderr.strip().splitlines() or [f"{shard}: exit code {ran.returncode}"])[-1])
    kept.send(shard, parts)
    return shard, time.time() - begun


def watch_head(address: str) -> None:
    """Ends the driver with one line if the head does not answer any more."""
    (host, _, port), answered = address.rpartition(":"), time.time()
    while time.time() - answered < HEAD_LOST_S:
        try:
            socket.create_connection((host, int(port)), timeout=5).close()
            answered = time.time()
        except OSError:
            pass
        time.sleep(2)
    # The main thread waits for tasks; an exception in this thread would not end it.
    print(f"touchline: the head {address} is lost; what is done stays: start a head and run this again", file=sys.stderr, flush=True)
    os._exit(3)


def lines_of(error: Exception) -> List[str]:
    """The lines of an error's text, at least one."""
    return (str(error).strip() or repr(error)).splitlines()


def run(plan: Dict[str, Any], place: str, address: Optional[str], touchline: Optional[str]) -> int:
    ray: Any = importlib.import_module("ray")
    try:
        ray.init(address=address, log_to_driver=False, logging_level="FATAL")
    except (ConnectionError, RuntimeError) as error:
        sys.exit(f"touchline: {lines_of(error)[0]}")
    threading.Thread(target=watch_head, args=(ray.get_runtime_context().gcs_address,), daemon=True).start()
    # A lost node or a killed program is no fault of the shard: any number of tries. Other errors end it at once.
    task = ray.remote(max_retries=-1, retry_exceptions=[Killed], scheduling_strategy="SPREAD", num_cpus=1)(do_shard)
    kept, text = Parts(place), ray.put(json.dumps(plan))
    frames_of: Dict[Any, int] = {}
    for match in plan["matches"]:
        # Cameras that are found already take the place of the task that finds them, so that labels have one case.
        found = ray.put((match["find"], 0.0))
        if not kept.has(match["find"]):
            found = task.remote(text, match["find"], place, touchline)
            frames_of[found] = 0
        for label in match["labels"]:
            if not kept.has(label["shard"]):
                shard = task.remote(text, label["shard"], place, touchline, found)
                frames_of[shard] = label["last"] - label["first"] + 1
    left: List[Any] = list(frames_of)
    begun, reported, frames, seconds, failed = time.time(), 0.0, 0, 0.0, 0
    while left:
        done, left = ray.wait(left, timeout=REPORT_S)
        for shard in done:
            try:
                seconds, frames = seconds + ray.get(shard)[1], frames + frames_of[shard]
            except Exception as error:
                failed += 1
                print(f"touchline: {lines_of(error)[-1]}", file=sys.stderr)
        if time.time() - reported > REPORT_S or not left:
            reported = time.time()
            print(f"touchline: {frames / (reported - begun):.1f} frames/s, {len(left)} shards left, {seconds / 3600:.2f} core hours", file=sys.stderr)
    return 1 if failed else 0


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m touchline.season", description="Does a season's shards by Ray.")
    parser.add_argument("plan", help="the plan that touchline plan wrote")
    parser.add_argument("--parts", required=True, help="the folder of parts, or s3://… or gs://…")
    parser.add_argument("--address", help="the head of a Ray cluster; this machine alone if absent")
    parser.add_argument("--touchline", help="the program on every node, if it is not beside the Python module")
    given = parser.parse_args()
    try:
        with open(given.plan, encoding="utf-8") as file:
            plan = json.load(file)
    except (OSError, ValueError) as error:
        sys.exit(f"touchline: cannot read the plan {given.plan}: {lines_of(error)[0]}")
    # Nodes have the plan from Ray, at another place. Shards are not named by paths.
    folder = os.path.dirname(os.path.abspath(given.plan))
    for match in plan["matches"]:
        match["frames"] = os.path.join(folder, match["frames"])
        for file_of_match in [match[key] for key in ("project", "forest") if key in match]:
            file_of_match["path"] = os.path.join(folder, file_of_match["path"])
    return run(plan, given.parts, given.address, given.touchline)


if __name__ == "__main__":
    sys.exit(main())
