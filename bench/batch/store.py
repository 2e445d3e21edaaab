"""Records and table in an object store: moto's server, which speaks S3 over HTTP, in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bench.batch.cluster import free_port
from bench.batch.records import make
from bench.batch.speed import different
from msd_ident.batching import table

_MSD = str(Path(sys.executable).parent / "msd")
_SERVER = "import sys; from moto.server import main; main(['-H', '127.0.0.1', '-p', sys.argv[1]])"


@contextmanager
def s3() -> Iterator[dict[str, str]]:
    """A server that runs for as long as the block; the environment in which fsspec finds it."""
    port = free_port()
    server = subprocess.Popen(
        [sys.executable, "-c", _SERVER, str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    address = f"http://127.0.0.1:{port}"
    keys = {"AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "test", "AWS_DEFAULT_REGION": "us-east-1"}
    try:
        for _ in range(300):
            try:
                urllib.request.urlopen(address, timeout=1.0)
                break
            except OSError:
                time.sleep(0.1)
        yield {**keys, "AWS_ENDPOINT_URL": address}
    finally:
        server.kill()
        server.wait()


def from_store(folder: Path, count: int) -> dict[str, Any]:
    """The same records from the disk and from the store: rows, digits, and the seconds of both."""
    import s3fs

    paths = make(folder / "records", count)
    local, told = folder / "local.parquet", {}
    with s3() as environment:
        files = s3fs.S3FileSystem(
            key="test", secret="test", endpoint_url=environment["AWS_ENDPOINT_URL"], skip_instance_cache=True
        )
        files.mkdir("lab")
        for path in paths:
            files.put_file(str(path), f"lab/{path.parent.name}/{path.name}")
        places = {"disk": (str(folder / "records"), str(local)), "store": ("s3://lab/", "s3://lab/table.parquet")}
        for name, (source, out) in places.items():
            began = time.perf_counter()
            own = {**os.environ, **environment}
            done = subprocess.run(
                [_MSD, "batch", source, "--out", out, "--overwrite"],
                env=own,
                capture_output=True,
                text=True,
                check=False,
            )
            told[name] = [done.returncode, done.stdout.strip(), round(time.perf_counter() - began, 1)]
        files.get_file("lab/table.parquet", str(folder / "store.parquet"))
    here, there = (table.read(str(folder / name)).to_pylist() for name in ("local.parquet", "store.parquet"))
    of = {row["sha256"]: row for row in here}
    renamed = [{**row, "path": of[row["sha256"]]["path"]} for row in there]
    return {**told, "rows": len(there), "rows with other digits": different(here, renamed)}
