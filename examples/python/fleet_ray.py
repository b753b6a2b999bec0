# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of a fleet as a data set of Ray: one row for each frame, to filter, group and write.

pip install clearance[ros] "ray[data]" mcap
python fleet_ray.py arm.urdf drive1.mcap drive2.mcap ...
"""

import dataclasses
import json
import os
import sys

import ray

import clearance.playing
import clearance.recordings


def rows(path, recipe, recording=None):
    """Pure: the rows depend on the recording and the robot only, so a lost task is simply done again."""
    for row in clearance.playing.rows(recording or path, recipe):
        # Columns are numbers and texts; the points are left out, as some rows have none.
        each = {
            name: value
            for name, value in dataclasses.asdict(row).items()
            if name not in ("at", "nearest", "parts", "checked")
        }
        yield each | {
            "path": path,
            "dropped": json.dumps(row.dropped),
            "point": -1 if row.point is None else row.point,
        }


def data_set(paths, recipe):
    """A data set with the columns path, stamp, topic, state, distance, lower, upper, link, ..."""
    return ray.data.from_items(list(paths)).flat_map(lambda item: list(rows(item["item"], recipe)))


def rows_of_messages(group, recipe):
    """The rows of one recording, whose messages Ray has read."""
    path = str(group["path"][0])
    # Ray has the name of a type as the recording has it, such as sensor_msgs/msg/PointCloud2.
    read = zip(group["topic"], group["schema_name"], map(int, group["log_time"]), group["data"], strict=True)
    found = list(rows(path, recipe, clearance.recordings.Messages(path, read)))
    return {name: [row[name] for row in found] for name in found[0]}


def data_set_in_a_bucket(paths, recipe):
    """The same of whole .mcap files that Ray reads, wherever it can: s3://..., gs://..., or a folder."""
    messages = ray.data.read_mcap(list(paths), include_paths=True)
    return messages.groupby("path").map_groups(lambda group: rows_of_messages(group, recipe), batch_format="numpy")


def main(urdf, *paths):
    recipe = {"file": os.path.abspath(urdf)}
    clearance.Robot.from_urdf(**recipe)  # its spheres are packed once; the workers find them in the cache
    ray.init(num_cpus=os.cpu_count(), include_dashboard=False, log_to_driver=False)  # Ray finds none in some containers
    least = {}
    for row in data_set(map(os.path.abspath, paths), recipe).take_all():
        if row["state"] not in ("unknown", "no_data"):
            least[row["path"]] = min(row["distance"], least.get(row["path"], row["distance"]))
    for path, distance in sorted(least.items()):
        print(f"{path}: {distance:.4f} m at the least")
    ray.shutdown()


if __name__ == "__main__":
    main(*sys.argv[1:])
