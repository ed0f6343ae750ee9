"""HyperQueue by its Python package, which has no command line: a server, a worker, and the submission of a job file.

    hq.py server FOLDER
    hq.py worker FOLDER
    hq.py submit FOLDER JOBFILE
"""

import os
import signal
import sys
import tomllib
from pathlib import Path

from hyperqueue import Client, Job
from hyperqueue.ffi.cluster import Cluster
from hyperqueue.ffi.protocol import ResourceRequest


def server(folder):
    cluster = Cluster(str(folder))
    print("up", flush=True)
    signal.pause()
    cluster.stop()


def worker(folder):
    """A worker in a process of its own. The package starts workers beside a server in one process only, so this starts a
    server that nobody asks anything, and shows its worker the way to the other one."""
    own = folder / f"worker-{os.getpid()}"
    own.mkdir()
    cluster = Cluster(str(own))
    current = own / "hq-current"
    current.unlink()
    current.symlink_to(os.path.realpath(folder / "hq-current"))
    cluster.add_worker(1)
    print("joined", flush=True)
    signal.pause()
    cluster.stop()


def submit(folder, path):
    description = tomllib.loads(Path(path).read_text())
    job = Job(max_fails=description.get("max_fails"), name=description["name"])
    tasks = {}
    for task in description["task"]:
        requests = [ResourceRequest(cpus=request["resources"]["cpus"]) for request in task["request"]]
        tasks[task["id"]] = job.program(
            task["command"],
            stdout=task["stdout"],
            stderr=task["stderr"],
            cwd=task.get("cwd"),
            deps=[tasks[id] for id in task.get("deps", [])],
            resources=requests,
            crash_limit=task["crash_limit"],
        )
    client = Client(folder)
    submitted = client.submit(job)
    if not client.wait_for_jobs([submitted], raise_on_error=False):
        print(client.get_failed_tasks(submitted))
        sys.exit(1)


def main():
    verb, folder, *rest = sys.argv[1:]
    {"server": server, "worker": worker, "submit": submit}[verb](Path(folder).resolve(), *rest)


main()
