# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of a fleet, played on Dask's workers: a table of rows, whatever worker dies.

pip install clearance[ros] "dask[distributed]"
python fleet_dask.py arm.urdf drive1.mcap drive2.mcap ...
"""

import os
import sys

from dask.distributed import Client, LocalCluster, as_completed

import clearance.playing


def rows(path, recipe):
    """Pure: the rows depend on the file and the robot only, so a lost task is simply done again."""
    return path, clearance.playing.rows(path, recipe)


def play_all(client, paths, recipe):
    """Yields (path, rows) as they come. A recording that cannot be opened is an error of its own, at its turn."""
    futures = client.map(rows, paths, recipe=recipe, pure=False)
    for future in as_completed(futures):
        yield future.result()


def main(urdf, *paths, workers=2):
    recipe = {"file": os.path.abspath(urdf)}
    clearance.Robot.from_urdf(**recipe)  # its spheres are packed once; the workers find them in the cache
    with (
        LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        for path, found in play_all(client, list(map(os.path.abspath, paths)), recipe):
            known = [row for row in found if row.state not in ("unknown", "no_data")]
            least = min(known, key=lambda row: row.distance, default=None)
            print(
                f"{path}: {len(found)} frames, {len(found) - len(known)} unknown"
                + (f", {least.distance:.4f} m at the least ({least.link} at {least.stamp:.3f})" if least else "")
            )


if __name__ == "__main__":
    main(*sys.argv[1:])
