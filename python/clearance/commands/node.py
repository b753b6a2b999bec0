# SPDX-License-Identifier: BSD-3-Clause
"""How far the robot is from what its sensors see, live: topics of ROS 2 in, the clearance out (no ROS is needed).

Publishes NAME/clearance (clearance_msgs/Clearance), NAME/range (sensor_msgs/Range: the lower end), NAME/markers and
NAME/stop (nav2_msgs/CollisionMonitorState). A sensor that says nothing for --timeout is unknown, and stops the robot.
"""

import signal
import sys

from clearance import _core
from clearance.commands import play


def add(parser):
    play.add_robot(parser)
    parser.add_argument(
        "--cloud", action="append", default=[], metavar="TOPIC", help="a PointCloud2; may be given several times"
    )
    parser.add_argument(
        "--image", action="append", default=[], metavar="TOPIC", help="a depth Image; may be given several times"
    )
    parser.add_argument(
        "--compressed-image",
        action="append",
        default=[],
        metavar="TOPIC",
        help="a CompressedImage that holds depth (compressedDepth); may be given several times",
    )
    parser.add_argument("--joint-topic", action="append", metavar="TOPIC", help="JointStates (default: /joint_states)")
    parser.add_argument("--tf-topic", action="append", metavar="TOPIC", help="TFMessages (default: /tf and /tf_static)")
    play.add_frames(parser)
    parser.add_argument("--name", default="clearance", help="of the topics that are published (default: clearance)")
    parser.add_argument("--domain", type=int, help="of DDS (default: ROS_DOMAIN_ID, or 0)")
    parser.add_argument("--margin", type=float, default=0.1, metavar="METRES", help="STOP below it (default: 0.1)")
    parser.add_argument("--slow", type=float, default=0.0, metavar="METRES", help="SLOWDOWN below it")
    parser.add_argument(
        "--timeout", type=float, default=0.5, metavar="SECONDS", help="without an answer, until unknown (default: 0.5)"
    )
    parser.add_argument(
        "--wait",
        type=float,
        default=0.05,
        metavar="SECONDS",
        help="how long a frame waits for joints and transforms up to its stamp (default: 0.05)",
    )
    parser.add_argument(
        "--max-delay",
        type=float,
        default=float("inf"),
        metavar="SECONDS",
        help="an older frame, by the system's clock, is unknown (default: any age)",
    )
    parser.add_argument(
        "--whole", action="store_true", help="ask for the robot's least distance only, not for every part's"
    )
    parser.add_argument("--seconds", type=float, default=float("inf"), help="end after so long")
    parser.add_argument("--report", action="store_true", help="say the latency at the end")


def run(asked):
    from clearance.node import Node  # it needs an extra

    node = Node(
        play.robot(asked),
        clouds=asked.cloud,
        images=asked.image,
        compressed=asked.compressed_image,
        joint_topic=asked.joint_topic or "/joint_states",
        tf_topics=asked.tf_topic or ("/tf", "/tf_static"),
        name=asked.name,
        domain=asked.domain,
        margin=asked.margin,
        slow=asked.slow,
        timeout=asked.timeout,
        wait=asked.wait,
        max_delay=asked.max_delay,
        device=asked.device,
        question=_core.MinDistance() if asked.whole else None,
        **play.frames(asked),
    )

    def stop(*_):
        node.stopped = True

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    print(
        f"listening on {', '.join(asked.cloud + asked.image + asked.compressed_image)}; publishing {asked.name}/clearance",
        file=sys.stderr,
        flush=True,
    )
    node.run(asked.seconds)
    if asked.report:
        print(node.report(), flush=True)
