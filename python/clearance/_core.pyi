# Written by python/stubs.
from collections.abc import Iterable, Iterator, Mapping, Sequence
import enum
from os import PathLike
from typing import Any, Generic, Literal, NoReturn, Protocol, TypeVar, overload

import numpy
from numpy.typing import ArrayLike, NDArray

Answer = TypeVar("Answer")

class _CanDlpack(Protocol):
    def __dlpack__(self, *given: Any, **named: Any) -> Any: ...

class _CanCuda(Protocol):
    @property
    def __cuda_array_interface__(self) -> Any: ...

_Array = ArrayLike | _CanDlpack | _CanCuda

none: int = 4294967295

class DistanceCertainty:
    """How certain each distance of an answer is: lower() of it is proven."""

    def lower(self, distance: float, part: int | None = None) -> float:
        """
        The solid is at least this far away, metres; 0 if nothing more is certain. part: whose distance it is; where the answer keeps each part's gap and tolerance, only that part's are taken off, and IndexError is raised for a part that is not there.
        """

    def to_dict(self) -> dict[str, Any]:
        """
        What it is made of: errors of computing, and by how much parts may be nearer than their primitives, metres.
        """

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

    def __repr__(self) -> str: ...

class Robot:
    """
    A robot's rigid parts, each with a tree that is built once, and its joints. It never changes; any number of queries and threads may share it.
    """

    @staticmethod
    def from_urdf(file: str | PathLike[str], model: Literal['spheres', 'triangles'] = 'spheres', spheres: int | None = None, geometry: Literal['collision', 'visual'] = 'collision', packages: Mapping[str, str | PathLike[str]] = {}, exclude_links: Sequence[str] = [], cache: bool = True, gltf_up: Literal['y', 'z'] | None = None) -> Robot:
        """
        Reads a URDF file and its meshes; or a description itself, such as ROS's robot_description or what xacro gives, whose meshes are found from the working folder. model: "spheres" (packed into each link, `spheres` of them; kept in the cache) or "triangles" (exact). packages: the folder of package://name. gltf_up: "y" or "z", which axis of glTF meshes is up; None: as a link's other geometry shows, else y, with a note. Raises RuntimeError if a file is damaged or missing, ValueError if an option cannot be.
        """

    @staticmethod
    def from_meshes(meshes: Mapping[str, object], model: Literal['spheres', 'triangles'] = 'spheres', spheres: int | None = None, name: str = 'robot', cache: bool = True, gltf_up: Literal['y', 'z'] | None = None) -> Robot:
        """
        One part for each {name: mesh}: a file's name, (vertices (n, 3), triangles (m, 3)), or an object with vertices and faces. Metres. gltf_up: as of from_urdf.
        """

    @staticmethod
    def from_spheres(spheres: Mapping[str, ArrayLike], gap: float = 0.0, tolerance: float = 0.0, name: str = 'robot') -> Robot:
        """
        One part for each {name: array (n, 4) of x, y, z, radius}. Metres. gap: the largest distance of the solid to its spheres (inf: unknown, so there is no lower bound).
        """

    def with_fields(self, bytes: int = 1048576, device: str = 'cpu', cache: bool = True) -> Robot:
        """
        The same robot with a field of so many bytes around each part: questions about many configurations take less time then, and no answer changes. device: where it is sampled, "cpu" (seconds a part) or "cuda:0"; once, and kept in the cache. If a part can have none, none is used, and `notes` say why.
        """

    @property
    def has_fields(self) -> bool:
        """Whether the robot was made by with_fields, and its fields are used."""

    def with_cells(self, bytes: int = 67108864, reach: float = 4.0, device: str = 'cpu') -> Robot:
        """
        The same robot with cells around each part, of at most so many bytes, as far as reach (metres): a GPU tells every point's distance in less time then, and no answer changes. device: where they are made, "cpu" (seconds a part) or "cuda:0". A part that can have none keeps its tree alone, and `notes` say why.
        """

    @property
    def has_cells(self) -> bool:
        """Whether the robot was made by with_cells, and a part has cells."""

    def attach(self, link: str, object: Robot, pose: ArrayLike | None = None) -> Robot:
        """
        The robot with an object that one of its links holds: joints, many configurations and gradients go on as before. object: a Robot without joints, of the same model, whose parts' names are new. pose: link-from-object, (4, 4). Near maps are not kept. Raises ValueError otherwise.
        """

    def release(self, parts: Sequence[str] = []) -> Robot:
        """
        The robot without these parts of what is attached, by their names; by default without all of it.
        """

    @property
    def attached(self) -> list[str]:
        """The names of the parts that are attached."""

    @property
    def name(self) -> str:
        """As its description, or the caller, names it."""

    @property
    def model(self) -> str:
        """"spheres" or "triangles": what stands for its solids."""

    @property
    def parts(self) -> list[str]:
        """The names of the parts, in their order."""

    @property
    def notes(self) -> list[str]:
        """What a person should know about its files."""

    @property
    def joints(self) -> list[str]:
        """The names of the movable joints, in the order of joint values."""

    @property
    def mimics(self) -> dict[str, tuple[str, float, float]]:
        """
        The joints that follow others, {name: (other, multiplier, offset)}. A value that joints, as a dictionary, gives one of them wins, as with ROS's robot_state_publisher.
        """

    @property
    def insides(self) -> list[str | None]:
        """
        How each part's inside is known: "closed", "caps", "flood" or "nothing"; None: there is no mesh.
        """

    @property
    def tolerances(self) -> NDArray[numpy.float64]:
        """
        By how much each part's solid may differ from the true surface, either way, (parts,): metres. Brackets are wider by it.
        """

    @property
    def gaps(self) -> NDArray[numpy.float64]:
        """
        How far each part's solid may be from its spheres or triangles, (parts,): metres; inf: unknown.
        """

    @property
    def limits(self) -> NDArray[numpy.float64]:
        """The joints' lower and upper limits, (joints, 2): radians or metres."""

    @property
    def rest(self) -> NDArray[numpy.float64]:
        """Each joint at 0, or at the limit nearest to it."""

    def poses(self, joints: _Array | Mapping[str, float] | None = None, base: ArrayLike | None = None, ignore_limits: bool = False, rest: bool = False) -> NDArray[numpy.float64]:
        """
        World-from-part of every part, (..., parts, 4, 4), for joints (..., joints) or {name: value}, where a joint of `mimics` may have a value of its own, too. base is world-from-base. Raises ValueError for values beyond the limits, and for joints that nothing is said of, unless rest: then they are at rest.
        """

    def link_pose(self, link: str, joints: _Array | Mapping[str, float] | None = None, base: ArrayLike | None = None, ignore_limits: bool = False, rest: bool = False) -> NDArray[numpy.float64]:
        """
        World-from-link of any link, (4, 4): with geometry or without, such as a camera's. Arguments are those of poses.
        """

    def jacobian(self, joints: _Array | Mapping[str, float] | None, part: int | str, at: ArrayLike, base: ArrayLike | None = None, ignore_limits: bool = False, rest: bool = False) -> NDArray[numpy.float64]:
        """
        What each joint does to a part, (6, joints): the velocity of its point at `at` (world, metres), then its angular velocity, per radian or metre.
        """

    def part_radii(self, joints: _Array | Mapping[str, float] | None, errors: ArrayLike | None = None, speeds: ArrayLike | None = None, delay: float = 0.0, ignore_limits: bool = False, rest: bool = False) -> NDArray[numpy.void]:
        """
        How far each part may be from where joints have it, for CertainDistance(parts=...): records of joints and delay, metres. errors (rad, m): by how much joints may be wrong; speeds, per second, in the seconds of delay; one number, or one a joint. Raises ValueError for what is negative or not finite.
        """

    def spheres(self, part: int | str) -> NDArray[numpy.float32]:
        """
        The inner spheres of a part, (n, 4): x, y, z, radius in the part's frame. Metres.
        """

    def mesh(self, part: int | str) -> tuple[NDArray[numpy.float64], NDArray[numpy.uint32]]:
        """
        The closed mesh of a part: vertices (n, 3) in its frame, metres, and triangles (m, 3).
        """

    def __reduce__(self) -> tuple[object, ...]: ...

    def __len__(self) -> int: ...

    def __repr__(self) -> str: ...

class Cloud:
    """Points or a depth image with a pose: a view of arrays where they lie."""

    def __len__(self) -> int: ...

    @property
    def device(self) -> str:
        """Where its array lies: "cpu", or "cuda:0" and so on."""

    def __reduce__(self) -> tuple[object, ...]: ...

    def __repr__(self) -> str: ...

def points(points: _Array, pose: ArrayLike | None = None, *, nearest: float = 0.0, farthest: float = float('inf'), sensor: ArrayLike | None = None, zero_is_missing: bool = False) -> Cloud:
    """
    A cloud of points, (n, 3) or (rows, columns, 3), float32 or float64, or structured with x, y, z; metres; read in place. pose: world-from-cloud, (4, 4). Points nearer to the sensor than nearest, or beyond farthest, do not count. zero_is_missing: a point at the sensor is none.
    """

def depth_image(depth: _Array, intrinsics: ArrayLike | None = None, pose: ArrayLike | None = None, *, scale: float | None = None, nearest: float = 0.0, farthest: float = float('inf'), minus_infinity_is_near: bool = True, rays: _Array | None = None) -> Cloud:
    """
    A depth image, (rows, columns): uint16 times scale (0.001 m unless given; 0 is missing, 65535 saturated), or float32 metres (REP 117, 118). intrinsics: (fx, fy, cx, cy) in pixels or K (3, 3); or rays, (rows, columns, 2): x / z and y / z of each pixel. pose: world-from-camera, z forward.
    """

def cropped(cloud: Cloud, *, inside: object | None = None, outside: object | None = None, pose: ArrayLike | None = None, height: object | None = None, plane: object | None = None) -> Cloud:
    """
    The same cloud without points that are no obstacles by their place in the world, which are counted as cropped. Obstacles are inside a box (2, 3), lower and upper corner, and outside another (pose: world-from-box, of both); at a height (low, high); and farther than thickness from plane, (a, b, c, d, thickness), of ax + by + cz = d. Metres. A cloud may be cropped again, by four of these in all.
    """

def uncertain(cloud: Cloud, noise: _Array | KinectNoise | StereoNoise | TofNoise | LidarNoise | None = None, *, shift: float = 0.0, turn: float = 0.0, max_speed: float = 0.0, age: float = 0.0) -> Cloud:
    """
    The same cloud, whose points may be elsewhere: for CertainDistance and others. noise: KinectNoise(), StereoNoise(...), TofNoise(...), LidarNoise(...), or an array of radii (m), one a point, float32, where the query asks. shift, turn: of the sensor's pose (m, rad). max_speed, age: of obstacles (m/s), of the cloud (s).
    """

def masked(cloud: Cloud, labels: _Array) -> Cloud:
    """
    The same cloud without some of its points, which are dropped as masked; the others keep their numbers. labels: one a point, read in place: uint8 as SelfFilter's labels (PointLabel.own is hidden), or bool (True is hidden). For queries on the cpu; Unseen has labels of its own.
    """

def half_pixel_of(rays: _Array | None) -> float:
    """
    Half the diagonal of the widest pixel at z = 1, of a table of rays (rows, columns, 2), float32: for Unseen.
    """

class Camera:
    """A calibrated camera of a ROS CameraInfo: which ray each pixel sees."""

    def __init__(self, width: int, height: int, k: ArrayLike, d: ArrayLike = (), distortion_model: str = '', *, binning: Sequence[int] = [0, 0], roi: Sequence[int] = [0, 0, 0, 0]) -> None:
        """
        width, height: pixels of the sensor. k: (3, 3), pixels. d: the coefficients of distortion_model (plumb_bob, rational_polynomial, equidistant, or none). binning: (x, y). roi: (x_offset, y_offset, width, height) in the sensor's pixels. Of a rectified image give P[:, :3] as k, and no d. ValueError if they contradict one another.
        """

    @property
    def width(self) -> int:
        """The width of the images, in pixels."""

    @property
    def height(self) -> int:
        """The height of the images, in pixels."""

    @property
    def intrinsics(self) -> tuple[float, float, float, float] | None:
        """
        (fx, fy, cx, cy), pixels; None if the lens bends rays or pixels have skew: then rays() is needed.
        """

    def rays(self) -> NDArray[numpy.float32]:
        """
        x / z and y / z of each pixel, (height, width, 2), float32: about a microsecond each. NaN where the lens folds or sees too wide, so the points of such pixels are dropped as not_finite. ValueError if all are.
        """

    def __reduce__(self) -> tuple[object, ...]: ...

    def __repr__(self) -> str: ...

class PairDistance:
    """A pair of a point and a part, and their distance."""

    @property
    def cloud(self) -> int | None:
        """The number of the point's cloud."""

    @property
    def point(self) -> int | None:
        """The number of the point in its cloud."""

    @property
    def part(self) -> int | None:
        """The number of the part."""

    @property
    def primitive(self) -> int | None:
        """
        The nearest primitive of the part; of equally near ones the lowest. ~0u: the point is inside the part's solid.
        """

    @property
    def distance(self) -> float:
        """Metres, as computed."""

    @property
    def link(self) -> str | None:
        """The name of that part, or None."""

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> PairDistance: ...

    def __deepcopy__(self, memo: Any) -> PairDistance: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class MotionClearanceResult:
    """
    The clearance over a motion. lower also covers the times between those that were asked. Times go from 0 to 1.
    """

    @property
    def state(self) -> State:
        """
        free: lower > margin. collision: at time some point is certainly not farther than margin. possible: neither. no_data: no valid point. Of uncertain clouds lower is about all places where points may be, and upper is not known (infinite).
        """

    @property
    def lower(self) -> float:
        """Metres: at no time is a point nearer. 0 if that is not certain."""

    @property
    def upper(self) -> float:
        """Metres: at time some point certainly is this near."""

    @property
    def time(self) -> float:
        """The asked time with the least upper."""

    @property
    def nearest(self) -> MinDistanceResult:
        """The least distance at time."""

    @property
    def to(self) -> float:
        """Where that piece ends."""

    @property
    def part(self) -> int | None:
        """The part that keeps lower down."""

    @property
    def queries(self) -> int:
        """How many times were asked."""

    @property
    def settled(self) -> bool:
        """
        lower is as good as tolerance asks, or as it can be. False: the queries were used up.
        """

    @property
    def link(self) -> str | None:
        """The name of that part, or None."""

    def __str__(self) -> str: ...

    @property
    def from_(self) -> float: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> MotionClearanceResult: ...

    def __deepcopy__(self, memo: Any) -> MotionClearanceResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class DropReason(enum.IntEnum):
    """
    Why a record or pixel gave no point. too_close: something is there, nearer than the sensor can measure (REP 117); nothing is free then. cropped: it is no obstacle by its place.
    """

    none = 0

    not_finite = 1

    missing = 2

    saturated = 3

    out_of_range = 4

    masked = 5

    too_close = 6

    cropped = 7

class Hiding:
    """Which room behind its pixels an image hides, in metres of z."""

    def __init__(self, nearest: float = 0.10000000149011612, farthest: float = 10.0, infinite_is_free: bool = False) -> None:
        """
        nearest: From this depth on a pixel without a return hides everything.
        farthest: Up to this depth pixels hide. What is farther does not matter.
        infinite_is_free: A pixel of +inf says that nothing is there (REP 117); otherwise it is no return.
        """

    @property
    def nearest(self) -> float:
        """From this depth on a pixel without a return hides everything."""

    @property
    def farthest(self) -> float:
        """Up to this depth pixels hide. What is farther does not matter."""

    @property
    def infinite_is_free(self) -> bool:
        """
        A pixel of +inf says that nothing is there (REP 117); otherwise it is no return.
        """

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class PointLabel(enum.IntEnum):
    """Whose a point is. One byte, so that a mask of labels is an image."""

    rest = 0

    own = 1

    uncertain = 2

    no_point = 3

class KinectNoise:
    """
    Microsoft's first Kinect: 1.2 mm + 1.9 mm/m^2 (z - 0.4 m)^2 along z. Nguyen, Izadi, Lovell, "Modeling Kinect sensor noise for improved 3D reconstruction and tracking", 3DIMPVT 2012. They measured walls at up to 60 degrees.
    """

    def __init__(self, k: float = 3.0) -> None:
        """k: How many standard deviations a point may be off."""

    @property
    def k(self) -> float:
        """How many standard deviations a point may be off."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class StereoNoise:
    """
    Stereo, active or passive, and structured light: z^2 s / (f B) along z. Gallup et al., "Variable baseline/resolution stereo", CVPR 2008; for structured light Khoshelham and Elberink, Sensors 12(2), 2012.
    """

    def __init__(self, focal_length: float = 0.0, baseline: float = 0.0, disparity: float = 0.0, k: float = 3.0) -> None:
        """
        focal_length: The focal length f, in pixels.
        baseline: The distance B between the cameras, in metres.
        disparity: The standard deviation s of a disparity, in pixels.
        k: How many standard deviations a point may be off.
        """

    @property
    def focal_length(self) -> float:
        """The focal length f, in pixels."""

    @property
    def baseline(self) -> float:
        """The distance B between the cameras, in metres."""

    @property
    def disparity(self) -> float:
        """The standard deviation s of a disparity, in pixels."""

    @property
    def k(self) -> float:
        """How many standard deviations a point may be off."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class TofNoise:
    """
    Time of flight: constant + square |p|^2, because light that returns falls with the square of the way. Lange and Seitz, "Solid-state time-of-flight range camera", IEEE Journal of Quantum Electronics 37(3), 2001.
    """

    def __init__(self, constant: float = 0.0, square: float = 0.0, k: float = 3.0) -> None:
        """
        constant: The standard deviation at distance 0, in metres.
        square: What the deviation grows by for each square metre of squared distance, in metres.
        k: How many standard deviations a point may be off.
        """

    @property
    def constant(self) -> float:
        """The standard deviation at distance 0, in metres."""

    @property
    def square(self) -> float:
        """
        What the deviation grows by for each square metre of squared distance, in metres.
        """

    @property
    def k(self) -> float:
        """How many standard deviations a point may be off."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class LidarNoise:
    """
    LiDAR: constant + share |p|, as data sheets say it. Glennie and Lichti, "Static calibration and analysis of the Velodyne HDL-64E S2", Remote Sensing 2(6), 2010.
    """

    def __init__(self, constant: float = 0.0, share: float = 0.0, k: float = 3.0) -> None:
        """
        constant: The standard deviation at distance 0, in metres.
        share: What the deviation grows by for each metre of distance, in metres.
        k: How many standard deviations a point may be off.
        """

    @property
    def constant(self) -> float:
        """The standard deviation at distance 0, in metres."""

    @property
    def share(self) -> float:
        """What the deviation grows by for each metre of distance, in metres."""

    @property
    def k(self) -> float:
        """How many standard deviations a point may be off."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class UncertaintyShares:
    """
    What lies between the distance of a pair and what is certain of it, one by one. Metres.
    """

    @property
    def noise(self) -> float:
        """What the sensor's noise adds to the point's radius."""

    @property
    def calibration(self) -> float:
        """What an inexact pose of the sensor adds to the point's radius."""

    @property
    def time(self) -> float:
        """What an obstacle's motion since the point was seen adds to its radius."""

    @property
    def joints(self) -> float:
        """What inexact joints add to the part's radius."""

    @property
    def delay(self) -> float:
        """What the part's motion while the answer is made adds to its radius."""

    @property
    def gap(self) -> float:
        """The part's gap and tolerance."""

    @property
    def balls(self) -> float:
        """The cloud's gap, if its points are balls that fill something."""

    @property
    def rounding(self) -> float:
        """What arithmetic may have lost."""

    def sum(self) -> float:
        """All shares together."""

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> UncertaintyShares: ...

    def __deepcopy__(self, memo: Any) -> UncertaintyShares: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class CertainPair:
    """
    The pair of a part that is least far apart for certain. distance is what was measured, lower what is left of it. The pair need not be the nearest. Without a valid point the distance is infinite.
    """

    @property
    def distance(self) -> float:
        """Metres; infinite without a pair."""

    @property
    def part(self) -> int | None:
        """The number of the robot's part; None without a pair."""

    @property
    def cloud(self) -> int | None:
        """Which cloud of the call; None without a pair."""

    @property
    def point(self) -> int | None:
        """Its number in its cloud, as in the input."""

    @property
    def primitive(self) -> int | None:
        """Which sphere or triangle of its part."""

    @property
    def at(self) -> tuple[float, float, float]:
        """The point in the world, metres."""

    @property
    def nearest(self) -> tuple[float, float, float]:
        """The nearest place on the robot in the world, metres."""

    @property
    def normal(self) -> tuple[float, float, float]:
        """
        The unit vector from the robot to the point; (0, 0, 0) if there is none.
        """

    @property
    def lower(self) -> float:
        """Metres that certainly lie between the point and the part."""

    @property
    def shares(self) -> UncertaintyShares:
        """What is taken off the distance, by its cause."""

    @property
    def to_ball(self) -> float:
        """Metres from the part to the ball around the point, the nearest ball."""

    @property
    def link(self) -> str | None:
        """The name of that part, or None."""

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> CertainPair: ...

    def __deepcopy__(self, memo: Any) -> CertainPair: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class CertainDistanceResult:
    """
    lower <= distance to the solid <= upper if no radius is too small. certain is the pair that decides lower. collision: a point is inside by more than all radii, which of a part that is a mesh is not known: possible. nominal is what min_distance says about the same points.
    """

    @property
    def state(self) -> State:
        """What the bracket means for a robot that is about to move."""

    @property
    def lower(self) -> float:
        """Metres: nothing is nearer; 0 if that is not certain."""

    @property
    def upper(self) -> float:
        """Metres: something certainly is this near."""

    @property
    def nominal(self) -> MinDistanceResult:
        """As if nothing were uncertain."""

    @property
    def certain(self) -> CertainPair:
        """The pair that is least far apart for certain."""

    @property
    def parts(self) -> NDArray[numpy.void]:
        """
        The answer about each part, in the order of the robot's parts; or how many parts there are.
        """

    @property
    def anywhere(self) -> int:
        """
        The number of points that may be anywhere: if it is not 0, nothing is free.
        """

    @property
    def any_radius(self) -> bool:
        """Some cloud was uncertain, or parts had radii."""

    def of(self, part: int | str) -> CertainPair:
        """
        The answer about one part, by its number or its link's name. Raises IndexError or ValueError if there is none.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> CertainDistanceResult: ...

    def __deepcopy__(self, memo: Any) -> CertainDistanceResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class PartRadius:
    """By how much a part may be elsewhere. Metres."""

    @property
    def joints(self) -> float:
        """How far it may be elsewhere because joints are not where they say."""

    @property
    def delay(self) -> float:
        """How far it may be elsewhere because it moves while the answer is made."""

    def sum(self) -> float:
        """Both together."""

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> PartRadius: ...

    def __deepcopy__(self, memo: Any) -> PartRadius: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class CertainDistance:
    """
    The least distance as measured, and what is certain of it: the least of (distance - the point's radius - the part's) over all pairs, less gap, tolerance and rounding. Clouds are uncertain; a bare one has radii 0. Raises ValueError if there is neither no radius nor one per part, or if one is negative or not finite.
    """

    def __init__(self, parts: ArrayLike = ()) -> None:
        """
        parts: The answer about each part, in the order of the robot's parts; or how many parts there are.
        """

    @property
    def parts(self) -> NDArray[numpy.void]:
        """
        The answer about each part, in the order of the robot's parts; or how many parts there are.
        """

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class PointDistances:
    """Distances of points, in the order of the clouds and their points."""

    @property
    def distance(self) -> NDArray[numpy.float32]:
        """
        Metres: to sphere parts signed, to triangle parts 0 inside; +inf beyond d_max, NaN where there is no point.
        """

    @property
    def part(self) -> NDArray[numpy.uint32]:
        """
        If which is set, the nearest part of each point, of equally near ones the lowest; ~0u: none.
        """

    @property
    def primitive(self) -> NDArray[numpy.uint32]:
        """
        If which is set, the nearest primitive of that part; ~0u: none, or the point is inside.
        """

    @property
    def counts(self) -> PointCounts:
        """
        How many points were seen, how many are valid, and why the others are not.
        """

    @property
    def certain(self) -> DistanceCertainty:
        """
        What is certain of each distance: the nearest part may be another in truth.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> PointDistances: ...

    def __deepcopy__(self, memo: Any) -> PointDistances: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class Distances:
    """
    Every point's distance to the nearest part (elsewhere d_max is called max_dist, or activation distance). A prepared question on a device remembers the primitive nearest to each point, by its number. Refused: d_max that is NaN.
    """

    def __init__(self, d_max: float = float('inf'), which: bool = False) -> None:
        """
        d_max: Metres; farther points are +inf, and cost next to nothing.
        which: Whether to tell which part and primitive is nearest, too.
        """

    @property
    def d_max(self) -> float:
        """Metres; farther points are +inf, and cost next to nothing."""

    @property
    def which(self) -> bool:
        """Whether to tell which part and primitive is nearest, too."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class PartDistances:
    """
    Each part's distance to all points: those of part k are of(k), in the order of the clouds and their points.
    """

    @property
    def distance(self) -> NDArray[numpy.float32]:
        """
        Metres: to sphere parts signed, to triangle parts 0 inside; +inf beyond d_max, NaN where there is no point.
        """

    @property
    def points(self) -> int:
        """The number of points of all clouds."""

    @property
    def counts(self) -> PointCounts:
        """
        How many points were seen, how many are valid, and why the others are not.
        """

    @property
    def certain(self) -> DistanceCertainty:
        """What is certain of each distance, by its part."""

    @property
    def parts(self) -> int:
        """The number of parts."""

    def of(self, part: int | str) -> NDArray[numpy.float32]:
        """
        The distances of a part to all points. Raises IndexError if there is no such part.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> PartDistances: ...

    def __deepcopy__(self, memo: Any) -> PartDistances: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class DistancesPerPart:
    """
    Every point's distance to every part: parts times points numbers. Refused: d_max that is NaN.
    """

    def __init__(self, d_max: float = float('inf')) -> None:
        """d_max: Metres; farther points are +inf."""

    @property
    def d_max(self) -> float:
        """Metres; farther points are +inf."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class CollisionResult:
    """
    Whether a point is within a margin (elsewhere: security margin, safety distance), and which point: the same on every run and backend.
    """

    @property
    def state(self) -> State:
        """
        collision: certainly a point is, which is never said if a cloud is uncertain. possible: a point may be. free: certainly none is, and nothing was too close to be measured. no_data: there was no valid point, or no part.
        """

    @property
    def cloud(self) -> int | None:
        """
        The lowest certain pair (by cloud, point, part), or else the lowest possible one.
        """

    @property
    def point(self) -> int | None:
        """Its number in its cloud, as in the input."""

    @property
    def part(self) -> int | None:
        """The number of the robot's part; None without a pair."""

    @property
    def counts(self) -> PointCounts:
        """
        How many points were seen, how many are valid, and why the others are not.
        """

    @property
    def link(self) -> str | None:
        """The name of that part, or None."""

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> CollisionResult: ...

    def __deepcopy__(self, memo: Any) -> CollisionResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class InCollision:
    """
    Is any point closer than the margins? Refused: neither one nor as many margins as parts, one that is NaN, and radii that are negative or not one for all parts, one per part or none.
    """

    def __init__(self, margins: float | ArrayLike = (0.0,), radii: float | ArrayLike = ()) -> None:
        """
        margins: Metres: one for all parts, or one per part.
        radii: By how much parts may be elsewhere, in metres: all alike, or each.
        """

    @property
    def margins(self) -> tuple[float, ...]:
        """Metres: one for all parts, or one per part."""

    @property
    def radii(self) -> tuple[float, ...]:
        """By how much parts may be elsewhere, in metres: all alike, or each."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class InCollisionsResult:
    """
    One state per configuration: that of in_collision for its poses. There is no witness, because it is chance which one is found first; min_distances gives one.
    """

    @property
    def of(self) -> NDArray[numpy.uint8]:
        """One for each configuration, in the shape that the configurations have."""

    @property
    def counts(self) -> PointCounts:
        """All 0 if there was no configuration."""

    @overload
    def first_not_free(self) -> int:
        """
        The first configuration that is not certainly farther away than its margins, or of.size().
        """

    @overload
    def first_not_free(self, horizon: int) -> NDArray[numpy.uint64]:
        """
        The first of each trajectory that is not free, counted from its beginning.
        """

    def trajectory(self, i: int, horizon: int) -> NDArray[numpy.uint8]:
        """
        If the configurations are several trajectories, [batch, horizon]: the states of trajectory i, and the first of each trajectory, counted from its beginning. Raises ValueError if they are not whole trajectories of horizon configurations, IndexError if there is no trajectory i.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> InCollisionsResult: ...

    def __deepcopy__(self, memo: Any) -> InCollisionsResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class InCollisions:
    """
    Is any point closer to a configuration than the margins? poses as for min_distances. Refused: poses that are no whole configurations, neither one nor as many margins as parts, one that is NaN, and radii as in_collision.
    """

    def __init__(self, margins: float | ArrayLike = (0.0,), radii: float | ArrayLike = ()) -> None:
        """
        margins: Metres: one for all parts, or one per part.
        radii: By how much parts may be elsewhere, in metres: all alike, or each.
        """

    @property
    def margins(self) -> tuple[float, ...]:
        """Metres: one for all parts, or one per part."""

    @property
    def radii(self) -> tuple[float, ...]:
        """By how much parts may be elsewhere, in metres: all alike, or each."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class MinDistance:
    """
    The least distance over all parts and all points, with its bracket and witness.
    """

    def __init__(self) -> None: ...

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class MinDistancePerPartResult:
    """The least distance of the robot, and of each part."""

    @property
    def all(self) -> MinDistanceResult:
        """
        The answer about all together; or about each part of each configuration, one after another.
        """

    @property
    def parts(self) -> NDArray[numpy.void]:
        """
        The answer about each part, in the order of the robot's parts; or how many parts there are.
        """

    def of(self, part: int | str) -> PartMinimum:
        """
        The answer about one part, by its number or its link's name. Raises IndexError or ValueError if there is none.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> MinDistancePerPartResult: ...

    def __deepcopy__(self, memo: Any) -> MinDistancePerPartResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class MinDistancePerPart:
    """
    The least distance of the robot, and of each part: each has its own bound.
    """

    def __init__(self) -> None: ...

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class SupportedDistance:
    """
    The nearest point that others confirm, and the nearer points that are alone.
    """

    @property
    def state(self) -> State:
        """
        What min_distance says about the confirmed points that were asked. possible: none is confirmed. no_data: there is no valid point.
        """

    @property
    def distance(self) -> float:
        """
        Metres. Infinite: no point is confirmed; NaN: none of the most nearest is.
        """

    @property
    def lower(self) -> float:
        """
        All confirmed points are certainly at least this far away; 0 if there is none.
        """

    @property
    def cloud(self) -> int | None:
        """Which cloud of the call; None without a pair."""

    @property
    def point(self) -> int | None:
        """Its number in its cloud, as in the input."""

    @property
    def part(self) -> int | None:
        """The number of the robot's part; None without a pair."""

    @property
    def primitive(self) -> int | None:
        """Which sphere or triangle of its part."""

    @property
    def isolated(self) -> int:
        """The number of nearer points that are not confirmed."""

    @property
    def nearest_isolated(self) -> PairDistance:
        """The nearest of the points that are not confirmed."""

    @property
    def counts(self) -> PointCounts:
        """
        How many points were seen, how many are valid, and why the others are not.
        """

    @property
    def link(self) -> str | None:
        """The name of that part, or None."""

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> SupportedDistance: ...

    def __deepcopy__(self, memo: Any) -> SupportedDistance: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class MinDistanceSupported:
    """
    The least distance over points that have at least min_points - 1 other valid points of all clouds within radius of them, by world coordinates in double. Refused: min_points or most of 0, most above 2^20, and a radius that is negative or not finite.
    """

    def __init__(self, min_points: int = 3, radius: float = 0.02, most: int = 4096) -> None:
        """
        min_points: How many points confirm one, itself among them.
        radius: Metres within which points confirm one another.
        most: The search ends after this many of the nearest points, each asked once.
        """

    @property
    def min_points(self) -> int:
        """How many points confirm one, itself among them."""

    @property
    def radius(self) -> float:
        """Metres within which points confirm one another."""

    @property
    def most(self) -> int:
        """
        The search ends after this many of the nearest points, each asked once.
        """

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class MinDistancesResult:
    """
    One result per configuration: that of min_distance for its poses, to the bit, if it is at most d_max. Otherwise the distance is infinite, there is no witness, and lower is what is certain: d_max less gap, tolerance and rounding.
    """

    @property
    def of(self) -> NDArray[numpy.void]:
        """One for each configuration, in the shape that the configurations have."""

    @overload
    def first_below(self, margin: float) -> int:
        """
        The first configuration that is not certainly farther away than margin metres, or of.size(). Without a valid point it is the first. Raises ValueError if the margin is negative or NaN: lower is 0 in a collision, too.
        """

    @overload
    def first_below(self, margin: float, horizon: int) -> NDArray[numpy.uint64]:
        """first_below of each trajectory, counted from its beginning."""

    def trajectory(self, i: int, horizon: int) -> NDArray[numpy.void]:
        """
        If the configurations are several trajectories, [batch, horizon]: the results of trajectory i. Raises ValueError if they are not whole trajectories of horizon configurations, IndexError if there is no trajectory i.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> MinDistancesResult: ...

    def __deepcopy__(self, memo: Any) -> MinDistancesResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class MinDistances:
    """
    The least distance of each configuration. poses are world-from-part: one per part of the first configuration, then those of the next; or a prepared question takes joint vectors of a joint_chain. It remembers where each configuration's last minimum was. Refused: poses that are no whole configurations, d_max that is NaN, and radii as in_collision.
    """

    def __init__(self, d_max: float = float('inf'), radii: float | ArrayLike = ()) -> None:
        """
        d_max: Metres. For a configuration farther away only that fact is reported, much faster.
        radii: By how much parts may be elsewhere, in metres: all alike, or each.
        """

    @property
    def d_max(self) -> float:
        """
        Metres. For a configuration farther away only that fact is reported, much faster.
        """

    @property
    def radii(self) -> tuple[float, ...]:
        """By how much parts may be elsewhere, in metres: all alike, or each."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class MinDistancesPerPartResult:
    """
    The result of min_distance for each part alone, as min_distances gives it. of(c) are those of configuration c, one per part.
    """

    @property
    def all(self) -> NDArray[numpy.void]:
        """
        The answer about all together; or about each part of each configuration, one after another.
        """

    @property
    def parts(self) -> int:
        """
        The answer about each part, in the order of the robot's parts; or how many parts there are.
        """

    def size(self) -> int:
        """How many configurations there are."""

    def of(self, c: int) -> NDArray[numpy.void]:
        """
        The results of a configuration's parts. Raises IndexError if there is no such configuration.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> MinDistancesPerPartResult: ...

    def __deepcopy__(self, memo: Any) -> MinDistancesPerPartResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class MinDistancesPerPart:
    """
    The least distance of each part of each configuration, otherwise as min_distances. Each part has its own bound, as a robot of that part alone; all share one structure over the clouds.
    """

    def __init__(self, d_max: float = float('inf'), radii: float | ArrayLike = ()) -> None:
        """
        d_max: Metres, as for min_distances.
        radii: By how much parts may be elsewhere, in metres: all alike, or each.
        """

    @property
    def d_max(self) -> float:
        """Metres, as for min_distances."""

    @property
    def radii(self) -> tuple[float, ...]:
        """By how much parts may be elsewhere, in metres: all alike, or each."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class NearestK:
    """
    The k nearest points of each part (elsewhere: kNN, top k): by computed distance, then cloud and point; a point may be in the lists of several parts. Refused: k of 0 or above 2^20, and d_max that is NaN.
    """

    def __init__(self, k: int = 1, d_max: float = float('inf')) -> None:
        """
        k: How many of each part.
        d_max: Metres; farther points do not count.
        """

    @property
    def k(self) -> int:
        """How many of each part."""

    @property
    def d_max(self) -> float:
        """Metres; farther points do not count."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class NearestKResult:
    """
    The pairs of part k begin at k * per_part, the nearest first, then by cloud and point. If there are fewer, the rest is at no point, and infinitely far.
    """

    @property
    def per_part(self) -> int:
        """The number of pairs in each part's list."""

    @property
    def pairs(self) -> NDArray[numpy.void]:
        """Pairs of a point and a part, of each part the nearest first."""

    @property
    def counts(self) -> PointCounts:
        """
        How many points were seen, how many are valid, and why the others are not.
        """

    @property
    def certain(self) -> DistanceCertainty:
        """What is certain of each pair's distance, by its part."""

    def of(self, part: int | str) -> NDArray[numpy.void]:
        """The pairs of a part. Raises IndexError if there is no such part."""

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> NearestKResult: ...

    def __deepcopy__(self, memo: Any) -> NearestKResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class PartWitnesses:
    """
    The witness of every part's minimum. On a device it is one kernel per cloud, after min_distance_per_part in a stream or graph. Refused: neither as many minima as parts, and one that is not of these poses and clouds.
    """

    def __init__(self, minima: NDArray[numpy.void]) -> None:
        """
        minima: Every part's least distance, as min_distance_per_part gives it.
        """

    @property
    def minima(self) -> NDArray[numpy.void]:
        """Every part's least distance, as min_distance_per_part gives it."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class SelfFilterCounts:
    """
    How many points of some clouds are the robot's. Plain data that a kernel may write or read.
    """

    @property
    def points(self) -> PointCounts:
        """How many points."""

    @property
    def own(self) -> int:
        """How many valid points are certainly the robot's."""

    @property
    def uncertain(self) -> int:
        """How many valid points are perhaps the robot's."""

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> SelfFilterCounts: ...

    def __deepcopy__(self, memo: Any) -> SelfFilterCounts: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class SelfFilterResult:
    """
    Whose each point is. A point is the robot's if it is certainly within the padding of a part's solid. If gap, tolerance or rounding leave that open, it is uncertain and not hidden: a point hidden wrongly may be an obstacle, a point kept wrongly stops a robot. Without a certificate every other point is uncertain.
    """

    @property
    def labels(self) -> NDArray[numpy.uint8]:
        """Whose each point is, in the order of the clouds and their points."""

    @property
    def offsets(self) -> NDArray[numpy.uint64]:
        """The labels of cloud c are offsets[c] to offsets[c + 1] - 1."""

    @property
    def rest(self) -> NDArray[numpy.uint32]:
        """The numbers of all valid points that are not hidden, ascending."""

    @property
    def counts(self) -> SelfFilterCounts:
        """
        How many points were seen, how many are valid, and why the others are not.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> SelfFilterResult: ...

    def __deepcopy__(self, memo: Any) -> SelfFilterResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class SelfFilter:
    """
    Which points are the robot itself? Refused: neither one nor as many paddings as parts, and one that is negative or not finite.
    """

    def __init__(self, padding: float | ArrayLike = (0.01,)) -> None:
        """
        padding: Metres around a part that belong to the robot: one number for all parts, or one per part. It has to cover the error of points on the robot's surface: noise, calibration, and the gap of the part's spheres.
        """

    @property
    def padding(self) -> tuple[float, ...]:
        """
        Metres around a part that belong to the robot: one number for all parts, or one per part. It has to cover the error of points on the robot's surface: noise, calibration, and the gap of the part's spheres.
        """

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class SignedDistances:
    """
    Every point's distance to the surface of parts that are closed meshes, negative inside. It is the least of all parts, so a point in several is as deep as in the one where it is deepest. Otherwise as distances; primitive is the nearest triangle, inside too, and points inside are within any d_max. Refused: d_max that is negative or NaN.
    """

    def __init__(self, d_max: float = float('inf'), which: bool = False) -> None:
        """
        d_max: Metres; farther points are +inf, and cost next to nothing.
        which: Whether to tell which part and triangle is nearest, too.
        """

    @property
    def d_max(self) -> float:
        """Metres; farther points are +inf, and cost next to nothing."""

    @property
    def which(self) -> bool:
        """Whether to tell which part and triangle is nearest, too."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class UnseenPart:
    """
    A part, and where the room that no camera sees is nearest to it: cloud is the camera, point the pixel, at lies on the pixel's way. Metres.
    """

    @property
    def distance(self) -> float:
        """Metres; infinite without a pair."""

    @property
    def part(self) -> int | None:
        """The number of the robot's part; None without a pair."""

    @property
    def cloud(self) -> int | None:
        """Which cloud of the call; None without a pair."""

    @property
    def point(self) -> int | None:
        """Its number in its cloud, as in the input."""

    @property
    def primitive(self) -> int | None:
        """Which sphere or triangle of its part."""

    @property
    def at(self) -> tuple[float, float, float]:
        """The point in the world, metres."""

    @property
    def nearest(self) -> tuple[float, float, float]:
        """The nearest place on the robot in the world, metres."""

    @property
    def normal(self) -> tuple[float, float, float]:
        """
        The unit vector from the robot to the point; (0, 0, 0) if there is none.
        """

    @property
    def lower(self) -> float:
        """
        Room that some camera hides and no camera sees is at least so far away.
        """

    @property
    def out_of_view(self) -> float:
        """
        The share, 0 to 1, of the ball around the part that no camera shows; nothing is said about it. NaN if a ray image may show the rest.
        """

    @property
    def to_edge(self) -> float:
        """
        If edges are asked for: at least so many metres lie between the ball around the part and all that no image shows. 0: some of the ball is not shown. NaN: there are ray images alone.
        """

    @property
    def link(self) -> str | None:
        """The name of that part, or None."""

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> UnseenPart: ...

    def __deepcopy__(self, memo: Any) -> UnseenPart: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class UnseenResult:
    """
    all: as a min_distance_result. If the robot reaches into what is hidden its state is unknown. seen counts pixels, valid those that hide room. With several cameras a place is hidden only if no camera sees it: lower holds for that, distance is an estimate, and upper is not known (infinite).
    """

    @property
    def all(self) -> MinDistanceResult:
        """
        The answer about all together; or about each part of each configuration, one after another.
        """

    @property
    def parts(self) -> NDArray[numpy.void]:
        """
        The answer about each part, in the order of the robot's parts; or how many parts there are.
        """

    @property
    def own_shadow(self) -> MinDistanceResult:
        """
        The least distance to what pixels of the robot's own points (masked) hide from all cameras together.
        """

    def of(self, part: int | str) -> UnseenPart:
        """
        The answer about one part, by its number or its link's name. Raises IndexError or ValueError if there is none.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> UnseenResult: ...

    def __deepcopy__(self, memo: Any) -> UnseenResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class Unseen:
    """
    How far is the robot from the room that depth images hide? Clouds are depth_image or ray_image, or masked or cropped ones (what is cropped hides as before), or uncertain ones of those: then hidden is what may be hidden, so that the state is not unknown but possible. Refused: depths that are no range, a ray image without half_pixel, not one label per pixel, and radii as in_collision.
    """

    def __init__(self, room: Hiding = Hiding(nearest=0.10000000149011612, farthest=10.0, infinite_is_free=False), half_pixel: float = 0.0, labels: ArrayLike = (), places: bool = False, edges: bool = False, radii: float | ArrayLike = ()) -> None:
        """
        room: Where hidden room begins and ends.
        half_pixel: What half_pixel_of says of a ray image's table; 0 without ray images.
        labels: Whose each pixel of all clouds is, as self_filter gives it; or none.
        places: Whether to tell of every part, as of the robot, at, nearest and normal.
        edges: Whether to tell to_edge: how far every part is from the edge of the view.
        radii: By how much parts may be elsewhere, in metres: all alike, or each.
        """

    @property
    def room(self) -> Hiding:
        """Where hidden room begins and ends."""

    @property
    def half_pixel(self) -> float:
        """What half_pixel_of says of a ray image's table; 0 without ray images."""

    @property
    def labels(self) -> NDArray[numpy.uint8]:
        """Whose each pixel of all clouds is, as self_filter gives it; or none."""

    @property
    def places(self) -> bool:
        """
        Whether to tell of every part, as of the robot, at, nearest and normal.
        """

    @property
    def edges(self) -> bool:
        """
        Whether to tell to_edge: how far every part is from the edge of the view.
        """

    @property
    def radii(self) -> tuple[float, ...]:
        """By how much parts may be elsewhere, in metres: all alike, or each."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class WithinResult:
    """
    Points near parts. The pairs of part k are offsets[k] to offsets[k + 1] - 1, the nearest first, then by cloud and point.
    """

    @property
    def offsets(self) -> NDArray[numpy.uint64]:
        """Where each part's pairs begin, and the number of all."""

    @property
    def pairs(self) -> NDArray[numpy.void]:
        """The pairs, with distances as computed, in metres."""

    @property
    def counts(self) -> PointCounts:
        """
        How many points were seen, how many are valid, and why the others are not.
        """

    @property
    def certain(self) -> DistanceCertainty:
        """What is certain of each pair's distance, by its part."""

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> WithinResult: ...

    def __deepcopy__(self, memo: Any) -> WithinResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class Within:
    """
    All pairs of a point and a part whose computed distance is at most radius metres. Refused: neither one nor as many radii as parts, and one that is NaN.
    """

    def __init__(self, radius: float | ArrayLike) -> None:
        """radius: Metres: one for all parts, or one per part."""

    @property
    def radius(self) -> tuple[float, ...]:
        """Metres: one for all parts, or one per part."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class Zone:
    """
    One zone of one part. A point counts if it may be nearer than the zone's threshold: arithmetic, gaps, tolerances and all radii are on the safe side.
    """

    @property
    def points(self) -> int:
        """How many points are in the zone."""

    @property
    def nearest(self) -> float:
        """
        The least distance of the zone's points, less their radii, as computed. Metres.
        """

    @property
    def nearest_cloud(self) -> int | None:
        """The cloud of the nearest point."""

    @property
    def nearest_point(self) -> int | None:
        """
        The nearest point's number in that cloud; of equally near ones the lowest.
        """

    @property
    def first_cloud(self) -> int | None:
        """The lowest cloud that has a point in the zone."""

    @property
    def first_point(self) -> int | None:
        """The lowest number in that cloud of a point in the zone."""

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> Zone: ...

    def __deepcopy__(self, memo: Any) -> Zone: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class ZonesResult:
    """What is in the zones of each part."""

    @property
    def per_part(self) -> int:
        """The number of zones of each part."""

    @property
    def min_points(self) -> int:
        """A zone with fewer points counts as empty (innermost)."""

    @property
    def zones(self) -> NDArray[numpy.void]:
        """The zones of a part, the innermost first, then those of the next part."""

    @property
    def counts(self) -> PointCounts:
        """
        How many points were seen, how many are valid, and why the others are not.
        """

    @property
    def unseen(self) -> int:
        """Points that there was no time for; any of them may be in any zone."""

    def of(self, part: int | str, z: int) -> Zone:
        """Zone z of a part. Raises IndexError if there is none."""

    def innermost(self) -> int:
        """
        The innermost zone of all parts with enough points: 0 is the nearest threshold, per_part means that all are empty. It is 0 for a frame without a valid point, without a part, with something too close to be measured, or with unseen points, because nothing is known then.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> ZonesResult: ...

    def __deepcopy__(self, memo: Any) -> ZonesResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class Zones:
    """
    Counts the points in zones around every part, in one pass. Refused: thresholds that are negative, not in order, none or not the same number for each part, min_points of 0, and radii as in_collision.
    """

    def __init__(self, thresholds: float | ArrayLike, each_part: bool = False, min_points: int = 1, radii: float | ArrayLike = ()) -> None:
        """
        thresholds: Metres, in ascending order: the same for every part, unless each_part is set.
        each_part: thresholds are those of each part in turn, equally many.
        min_points: A zone with fewer counts as empty (innermost); its points are still reported.
        radii: By how much parts may be elsewhere, in metres: all alike, or each.
        """

    @property
    def thresholds(self) -> tuple[float, ...]:
        """
        Metres, in ascending order: the same for every part, unless each_part is set.
        """

    @property
    def each_part(self) -> bool:
        """thresholds are those of each part in turn, equally many."""

    @property
    def min_points(self) -> int:
        """
        A zone with fewer counts as empty (innermost); its points are still reported.
        """

    @property
    def radii(self) -> tuple[float, ...]:
        """By how much parts may be elsewhere, in metres: all alike, or each."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class State(enum.IntEnum):
    """What a bracket means for a robot that is about to move."""

    free = 0

    possible = 1

    collision = 2

    no_data = 3

    unknown = 4

class PartMinimum:
    """
    The least distance of one part. Without a valid point within its bound it is infinite, at no point.
    """

    @property
    def distance(self) -> float:
        """Metres; infinite without a pair."""

    @property
    def cloud(self) -> int | None:
        """Which cloud of the call; None without a pair."""

    @property
    def point(self) -> int | None:
        """Its number in its cloud, as in the input."""

    @property
    def primitive(self) -> int | None:
        """Which sphere or triangle of its part."""

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> PartMinimum: ...

    def __deepcopy__(self, memo: Any) -> PartMinimum: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class PartWitness:
    """
    The pair that attains a part's least distance, in world coordinates, as in a min_distance_result. Without a pair the numbers are none and the distance is infinite.
    """

    @property
    def distance(self) -> float:
        """Metres; infinite without a pair."""

    @property
    def part(self) -> int | None:
        """The number of the robot's part; None without a pair."""

    @property
    def cloud(self) -> int | None:
        """Which cloud of the call; None without a pair."""

    @property
    def point(self) -> int | None:
        """Its number in its cloud, as in the input."""

    @property
    def primitive(self) -> int | None:
        """Which sphere or triangle of its part."""

    @property
    def at(self) -> tuple[float, float, float]:
        """The point in the world, metres."""

    @property
    def nearest(self) -> tuple[float, float, float]:
        """The nearest place on the robot in the world, metres."""

    @property
    def normal(self) -> tuple[float, float, float]:
        """
        The unit vector from the robot to the point; (0, 0, 0) if there is none.
        """

    @property
    def link(self) -> str | None:
        """The name of that part, or None."""

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> PartWitness: ...

    def __deepcopy__(self, memo: Any) -> PartWitness: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class PointCounts:
    """
    How many points a scan has seen, how many of them are valid, and why the others are not.
    """

    @property
    def seen(self) -> int:
        """How many points or pixels were looked at."""

    @property
    def valid(self) -> int:
        """How many of them are valid."""

    @property
    def dropped(self) -> dict[str, int]:
        """How many points were dropped, by drop_reason; [none] stays 0."""

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> PointCounts: ...

    def __deepcopy__(self, memo: Any) -> PointCounts: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class MinDistanceResult:
    """
    The clearance of a robot, its bracket and its witness; plain data that a kernel may write or read.  lower <= distance to the solid <= upper (0 inside it), float errors included. With no_data the distance is NaN, lower 0 and upper infinite, so that if (r.lower < margin) stop() stops.
    """

    @property
    def state(self) -> State:
        """What the bracket means for a robot that is about to move."""

    @property
    def distance(self) -> float:
        """Metres; to sphere parts signed, to triangle parts 0 inside."""

    @property
    def lower(self) -> float:
        """Metres: nothing is nearer; 0 if that is not certain."""

    @property
    def upper(self) -> float:
        """Metres: something certainly is this near."""

    @property
    def cloud(self) -> int | None:
        """The number of the nearest point's cloud."""

    @property
    def point(self) -> int | None:
        """The number of the nearest point in its cloud."""

    @property
    def part(self) -> int | None:
        """The number of the nearest part."""

    @property
    def primitive(self) -> int | None:
        """
        The number of the part's nearest primitive; of equally near ones the lowest.
        """

    @property
    def at(self) -> tuple[float, float, float]:
        """The nearest point, in world coordinates."""

    @property
    def nearest(self) -> tuple[float, float, float]:
        """The primitive's point that is nearest to it, in world coordinates."""

    @property
    def normal(self) -> tuple[float, float, float]:
        """The unit vector from robot to point; (0,0,0) if there is none."""

    @property
    def seen(self) -> int:
        """How many points or pixels were looked at."""

    @property
    def valid(self) -> int:
        """How many of them are valid."""

    @property
    def dropped(self) -> dict[str, int]:
        """How many points were dropped, by drop_reason; [none] stays 0."""

    @property
    def link(self) -> str | None:
        """The name of that part, or None."""

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> MinDistanceResult: ...

    def __deepcopy__(self, memo: Any) -> MinDistanceResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class SeenAndUnseenResult:
    """As unseen, and as min_distance about the same pixels."""

    @property
    def all(self) -> MinDistanceResult:
        """
        The answer about all together; or about each part of each configuration, one after another.
        """

    @property
    def parts(self) -> NDArray[numpy.void]:
        """
        The answer about each part, in the order of the robot's parts; or how many parts there are.
        """

    @property
    def own_shadow(self) -> MinDistanceResult:
        """
        The least distance to what pixels of the robot's own points (masked) hide from all cameras together.
        """

    @property
    def seen(self) -> MinDistanceResult:
        """
        The least distance to what cameras see. Pixels labelled own are dropped as masked.
        """

    def of(self, part: int | str) -> UnseenPart:
        """
        The answer about one part, by its number or its link's name. Raises IndexError or ValueError if there is none.
        """

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> SeenAndUnseenResult: ...

    def __deepcopy__(self, memo: Any) -> SeenAndUnseenResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class SeenAndUnseen:
    """
    Asks min_distance and unseen about one frame of images, on a device at the same time. Refused: as unseen. Images that are uncertain have no such minimum: certain_distance is asked about them.
    """

    def __init__(self, room: Hiding = Hiding(nearest=0.10000000149011612, farthest=10.0, infinite_is_free=False), half_pixel: float = 0.0, labels: ArrayLike = (), places: bool = False, edges: bool = False, radii: float | ArrayLike = ()) -> None:
        """
        room: Where hidden room begins and ends.
        half_pixel: What half_pixel_of says of a ray image's table; 0 without ray images.
        labels: Whose each pixel of all clouds is, as self_filter gives it; or none.
        places: Whether to tell of every part, as of the robot, at, nearest and normal.
        edges: Whether to tell to_edge: how far every part is from the edge of the view.
        radii: By how much parts may be elsewhere, in metres: all alike, or each.
        """

    @property
    def room(self) -> Hiding:
        """Where hidden room begins and ends."""

    @property
    def half_pixel(self) -> float:
        """What half_pixel_of says of a ray image's table; 0 without ray images."""

    @property
    def labels(self) -> NDArray[numpy.uint8]:
        """Whose each pixel of all clouds is, as self_filter gives it; or none."""

    @property
    def places(self) -> bool:
        """
        Whether to tell of every part, as of the robot, at, nearest and normal.
        """

    @property
    def edges(self) -> bool:
        """
        Whether to tell to_edge: how far every part is from the edge of the view.
        """

    @property
    def radii(self) -> tuple[float, ...]:
        """By how much parts may be elsewhere, in metres: all alike, or each."""

    def __repr__(self) -> str: ...

    def __reduce__(self) -> tuple[object, ...]: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

class PairClearance:
    """
    The least distance of two parts, a < b, and which spheres attain it, numbered as they were given. Metres; below 0 if they overlap. The solids are at least lower apart.
    """

    @property
    def a(self) -> int | None:
        """The number of one part; None without a pair."""

    @property
    def b(self) -> int | None:
        """The number of the other, higher one."""

    @property
    def distance(self) -> float:
        """Metres; infinite without a pair."""

    @property
    def lower(self) -> float:
        """Metres: nothing is nearer; 0 if that is not certain."""

    @property
    def sphere_a(self) -> int | None:
        """Which sphere of part a, as it was given."""

    @property
    def sphere_b(self) -> int | None:
        """Which sphere of part b."""

    @property
    def at_a(self) -> tuple[float, float, float]:
        """The nearest places of both spheres, in the world, metres."""

    @property
    def at_b(self) -> tuple[float, float, float]:
        """
        The place on sphere b that is nearest to sphere a, in the world, metres.
        """

    @property
    def normal(self) -> tuple[float, float, float]:
        """The unit vector from b to a; 0 if their centres coincide."""

    @property
    def links(self) -> tuple[str, str] | None:
        """The names of both parts, or None."""

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> PairClearance: ...

    def __deepcopy__(self, memo: Any) -> PairClearance: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class SelfClearance:
    """
    The least distance of all pairs, in world coordinates. lower <= distance of the solids <= upper. collision: two parts certainly overlap; no_data: there is no pair.
    """

    @property
    def a(self) -> int | None:
        """The number of one part; None without a pair."""

    @property
    def b(self) -> int | None:
        """The number of the other, higher one."""

    @property
    def distance(self) -> float:
        """Metres; infinite without a pair."""

    @property
    def lower(self) -> float:
        """Metres: nothing is nearer; 0 if that is not certain."""

    @property
    def sphere_a(self) -> int | None:
        """Which sphere of part a, as it was given."""

    @property
    def sphere_b(self) -> int | None:
        """Which sphere of part b."""

    @property
    def at_a(self) -> tuple[float, float, float]:
        """The nearest places of both spheres, in the world, metres."""

    @property
    def at_b(self) -> tuple[float, float, float]:
        """
        The place on sphere b that is nearest to sphere a, in the world, metres.
        """

    @property
    def normal(self) -> tuple[float, float, float]:
        """The unit vector from b to a; 0 if their centres coincide."""

    @property
    def state(self) -> State:
        """What the bracket means for a robot that is about to move."""

    @property
    def upper(self) -> float:
        """Metres: something certainly is this near."""

    @property
    def links(self) -> tuple[str, str] | None:
        """The names of both parts, or None."""

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> SelfClearance: ...

    def __deepcopy__(self, memo: Any) -> SelfClearance: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class SelfDistanceResult:
    """
    The least distance of all pairs, and each pair's: first those of part 0, then those of part 1 with higher ones.
    """

    @property
    def a(self) -> int | None:
        """The number of one part; None without a pair."""

    @property
    def b(self) -> int | None:
        """The number of the other, higher one."""

    @property
    def distance(self) -> float:
        """Metres; infinite without a pair."""

    @property
    def lower(self) -> float:
        """Metres: nothing is nearer; 0 if that is not certain."""

    @property
    def sphere_a(self) -> int | None:
        """Which sphere of part a, as it was given."""

    @property
    def sphere_b(self) -> int | None:
        """Which sphere of part b."""

    @property
    def at_a(self) -> tuple[float, float, float]:
        """The nearest places of both spheres, in the world, metres."""

    @property
    def at_b(self) -> tuple[float, float, float]:
        """
        The place on sphere b that is nearest to sphere a, in the world, metres.
        """

    @property
    def normal(self) -> tuple[float, float, float]:
        """The unit vector from b to a; 0 if their centres coincide."""

    @property
    def state(self) -> State:
        """What the bracket means for a robot that is about to move."""

    @property
    def upper(self) -> float:
        """Metres: something certainly is this near."""

    @property
    def pairs(self) -> NDArray[numpy.void]:
        """Each pair that can meet."""

    @property
    def links(self) -> tuple[str, str] | None:
        """The names of both parts, or None."""

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

    def to_dict(self) -> dict[str, Any]:
        """
        All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.
        """

    def __copy__(self) -> SelfDistanceResult: ...

    def __deepcopy__(self, memo: Any) -> SelfDistanceResult: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

class Query(Generic[Answer]):
    """
    A question prepared for a robot on one device: make it once and ask it in every frame. Any number of threads may call it.
    """

    @overload
    def __init__(self: Query[CertainDistanceResult], robot: Robot, question: CertainDistance | type[CertainDistance], device: str = 'cpu', threads: int | None = None) -> None:
        """
        question: such as MinDistance(). device: "cpu", or "cuda:0" and so on. threads: how many work on the cpu; None: all.
        """

    @overload
    def __init__(self: Query[PointDistances], robot: Robot, question: Distances | type[Distances], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[PartDistances], robot: Robot, question: DistancesPerPart | type[DistancesPerPart], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[CollisionResult], robot: Robot, question: InCollision | type[InCollision], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[InCollisionsResult], robot: Robot, question: InCollisions | type[InCollisions], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[MinDistanceResult], robot: Robot, question: MinDistance | type[MinDistance], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[MinDistancePerPartResult], robot: Robot, question: MinDistancePerPart | type[MinDistancePerPart], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[SupportedDistance], robot: Robot, question: MinDistanceSupported | type[MinDistanceSupported], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[MinDistancesResult], robot: Robot, question: MinDistances | type[MinDistances], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[MinDistancesPerPartResult], robot: Robot, question: MinDistancesPerPart | type[MinDistancesPerPart], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[NearestKResult], robot: Robot, question: NearestK | type[NearestK], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[NDArray[numpy.void]], robot: Robot, question: PartWitnesses | type[PartWitnesses], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[SeenAndUnseenResult], robot: Robot, question: SeenAndUnseen | type[SeenAndUnseen], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[SelfFilterResult], robot: Robot, question: SelfFilter | type[SelfFilter], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[PointDistances], robot: Robot, question: SignedDistances | type[SignedDistances], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[UnseenResult], robot: Robot, question: Unseen | type[Unseen], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[WithinResult], robot: Robot, question: Within | type[Within], device: str = 'cpu', threads: int | None = None) -> None: ...

    @overload
    def __init__(self: Query[ZonesResult], robot: Robot, question: Zones | type[Zones], device: str = 'cpu', threads: int | None = None) -> None: ...

    def __call__(self, points: _Array | Cloud | None = None, joints: _Array | Mapping[str, float] | None = None, *, poses: ArrayLike | None = None, base: ArrayLike | None = None, cloud_pose: ArrayLike | None = None, depth: _Array | None = None, intrinsics: ArrayLike | None = None, rays: _Array | None = None, depth_scale: float | None = None, camera_pose: ArrayLike | None = None, clouds: Iterable[_Array | Cloud] | None = None, stream: object | None = None, question: object | None = None, ignore_limits: bool = False, rest: bool = False) -> Answer:
        """
        Asks about one frame and waits for the answer. Where the robot is: joints (joints,) or {name: value}, with base (world-from-base); or poses (parts, 4, 4), world-from-part; rest: what nothing is said of is at rest, or at the base. Questions about many configurations take joints (..., joints) or poses (..., parts, 4, 4). What is seen: points with cloud_pose; depth with intrinsics or rays and camera_pose; or clouds, a sequence of points(...) and depth_image(...). question: other options for this call. Raises ValueError with a sentence that names the argument.
        """

    def worlds(self, clouds: Iterable[_Array | Cloud] | None, joints: _Array | Mapping[str, float] | None = None, splits: ArrayLike | None = None, *, poses: ArrayLike | None = None, base: ArrayLike | None = None, stream: object | None = None, question: object | None = None, ignore_limits: bool = False, rest: bool = False) -> MinDistancesResult | InCollisionsResult:
        """
        Asks about many worlds, each with its own cloud, in one call: side by side on the cpu. clouds: one for each world; or one array (n, 3) of all points, of which world w has splits[w] to splits[w + 1] - 1. joints (worlds, ..., joints), poses (worlds, ..., parts, 4, 4), base (4, 4) or (worlds, 4, 4). Of MinDistance and MinDistances the answer is a MinDistancesResult of shape (worlds, ...), of InCollision and InCollisions an InCollisionsResult. Points have their numbers in their world.
        """

    def enqueue(self, points: _Array | Cloud | None = None, joints: _Array | Mapping[str, float] | None = None, *, poses: ArrayLike | None = None, base: ArrayLike | None = None, cloud_pose: ArrayLike | None = None, depth: _Array | None = None, intrinsics: ArrayLike | None = None, rays: _Array | None = None, depth_scale: float | None = None, camera_pose: ArrayLike | None = None, clouds: Iterable[_Array | Cloud] | None = None, out: object | None = None, capacity: int | None = None, stream: object | None = None, question: object | None = None, ignore_limits: bool = False, rest: bool = False) -> DeviceAnswer:
        """
        Asks on a device, without waiting: clouds are arrays there, and so is the answer, which work in stream waits for. stream: an integer (-1: you see to the order; 1, 2, or a pointer), or one of torch or CuPy; None: the legacy default one. out: arrays to write, by name, such as the last answer. capacity: of pairs. Raises ValueError as a call.
        """

    @property
    def question(self) -> object:
        """With the options that a call may replace."""

    @property
    def robot(self) -> Robot:
        """The robot that is asked about."""

    @property
    def device(self) -> str:
        """Where it asks: "cpu", or "cuda:0" and so on."""

    @property
    def threads(self) -> int | None:
        """How many threads work on the cpu; None: all."""

    def __reduce__(self) -> tuple[object, ...]: ...

    def __repr__(self) -> str: ...

def motion_clearance(query: Query, start: ArrayLike | Mapping[str, float], end: ArrayLike | Mapping[str, float], points: _Array | Cloud | None = None, *, base: ArrayLike | None = None, cloud_pose: ArrayLike | None = None, depth: _Array | None = None, intrinsics: ArrayLike | None = None, rays: _Array | None = None, depth_scale: float | None = None, camera_pose: ArrayLike | None = None, clouds: Iterable[_Array | Cloud] | None = None, stream: object | None = None, tolerance: float = 0.01, margin: float = 0.0, most_queries: int = 1000, radii: ArrayLike | None = None, ignore_limits: bool = False) -> MotionClearanceResult:
    """
    How near points come over a whole motion, also between the times that are asked: never more than in truth. query: of MinDistancePerPart. start, end: joints, each of which moves at constant speed; or arrays of poses (parts, 4, 4), between which parts go straight. tolerance: how far lower may be below the least at an asked time (m). margin: what state compares with (m). radii: by how much parts may be elsewhere (m). What is seen: as in a call.
    """

class DeviceArray:
    """
    An array in a CUDA device's memory, which it owns: for torch, CuPy, JAX and Numba by DLPack and __cuda_array_interface__. array["distance"] views a field of records. Its memory is given back with the last view, which waits for the device.
    """

    def __init__(self, array: ArrayLike, device: str = 'cuda:0') -> None:
        """Copies an array of numbers or records from the host."""

    @property
    def shape(self) -> tuple[int, ...]:
        """As NumPy's."""

    @property
    def dtype(self) -> Any:
        """As NumPy's."""

    @property
    def device(self) -> str:
        """Where it lies: "cuda:0" and so on."""

    def numpy(self) -> NDArray[Any]:
        """A copy on the host, after what is enqueued has been written."""

    def __getitem__(self, field: str) -> DeviceArray: ...

    def __array__(self, *given: Any, **named: Any) -> NoReturn: ...

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]: ...

    def __dlpack__(self, stream: int = None, **others: Any) -> Any: ...

    def __dlpack_device__(self) -> tuple[int, int]: ...

    def __repr__(self) -> str: ...

class DeviceAnswer:
    """
    What Query.enqueue returns: the arrays that a device writes, by the names that C++ has. It may still be on its way; work in the stream that was given waits for it, and so does .numpy() of an array.
    """

    def __getitem__(self, name: str) -> Any: ...

    def keys(self) -> list[str]:
        """The names of the arrays."""

    def __iter__(self) -> Iterator[str]: ...

    def __len__(self) -> int: ...

    @property
    def certain(self) -> DistanceCertainty | None:
        """How certain each distance is, where a question says it; or None."""

    def wait(self) -> None:
        """Waits until it is written."""

    def __repr__(self) -> str: ...

def approach_speed(result: MinDistanceResult | PartWitness, velocity: ArrayLike, turning: ArrayLike = (0.0, 0.0, 0.0), about: ArrayLike = (0.0, 0.0, 0.0), point_velocity: ArrayLike = (0.0, 0.0, 0.0)) -> float | None:
    """
    How fast the least distance shrinks, m/s; negative if the pair moves apart, None where it has no gradient. The result's part moves with velocity (m/s) at about and turns by turning (rad/s); point_velocity is the point's. All in world axes, such as Robot.jacobian(q, part, about) times joint speeds. Other pairs may close faster.
    """

def protective_separation(*, human_speed: float, robot_speed: float, reaction_time: float, stopping_time: float, stopping_distance: float, intrusion: float, human_uncertainty: float, robot_uncertainty: float) -> float:
    """
    The protective separation distance of ISO/TS 15066, which ISO 10218-2:2025 has taken over, in metres: human_speed (reaction_time + stopping_time) + robot_speed reaction_time + the other terms; m/s, s, m. Compare it with a result's lower. It is the formula and nothing more: no safety function. Raises ValueError for a number that is negative or not finite.
    """

class PartPairs:
    """
    Which parts of a robot can meet, as part_pairs and sample_pairs say. Iterating gives pairs of names, and ("hand", "base") in pairs says whether one is there. It never changes.
    """

    def without(self, a: int | str, b: int | str) -> PartPairs:
        """The same without one pair: a and b are parts' names or numbers."""

    def including(self, a: int | str, b: int | str) -> PartPairs:
        """The same with one pair more."""

    @property
    def notes(self) -> list[str]:
        """What a person should know about the SRDF file."""

    @property
    def always(self) -> list[tuple[str, str]]:
        """Pairs that sample_pairs removed because they touch in all samples."""

    @property
    def never(self) -> list[tuple[str, str]]:
        """
        Pairs that sample_pairs removed because they are beyond reach in all samples.
        """

    def __len__(self) -> int: ...

    def __iter__(self) -> Iterator[tuple[str, str]]: ...

    def __contains__(self, pair: tuple[str | int, str | int]) -> bool: ...

    def __copy__(self) -> PartPairs: ...

    def __deepcopy__(self, memo: Any) -> PartPairs: ...

    def __getstate__(self) -> tuple[object, ...]: ...

    def __setstate__(self, arg: tuple, /) -> None: ...

    def __repr__(self) -> str: ...

def part_pairs(robot: Robot, srdf: str | PathLike[str] | None = None) -> PartPairs:
    """
    Which parts of a robot can meet. Without an SRDF file all pairs but neighbours in its joints: a part and the nearest one above it, and parts that fixed joints hold together. With one (a file or its text) all but what it disables, in MoveIt's order; what is noted is in notes. Raises RuntimeError for a damaged file.
    """

def sample_pairs(robot: Robot, joints: _Array | Mapping[str, float] | None, reach: float, pairs: PartPairs | None = None, *, poses: ArrayLike | None = None, ignore_limits: bool = False) -> PartPairs:
    """
    The pairs without those that touch in all of some configurations, joints (n, joints) spread over the limits, and those that are farther apart than reach (metres) in all. Samples prove nothing: what they miss, the answers miss. pairs: from part_pairs; None: part_pairs(robot).
    """

class SelfQuery:
    """
    Asks how far a robot of inner spheres is from itself, on the CPU: make it once, with the pairs of parts that can meet, and ask it of every configuration.
    """

    def __init__(self, robot: Robot, pairs: object | None = None) -> None:
        """
        pairs: what part_pairs or sample_pairs returned; None: part_pairs(robot). Raises ValueError for a robot of triangles, and for pairs of another one.
        """

    def __call__(self, joints: _Array | Mapping[str, float] | None = None, *, poses: ArrayLike | None = None, base: ArrayLike | None = None, ignore_limits: bool = False, rest: bool = False) -> SelfDistanceResult:
        """
        The least distance of all pairs, and each pair's. Where the robot is: as for Query.
        """

    def many(self, joints: _Array | Mapping[str, float] | None = None, *, poses: ArrayLike | None = None, base: ArrayLike | None = None, ignore_limits: bool = False, rest: bool = False) -> NDArray[numpy.void]:
        """
        The least distance in each of many configurations, joints (..., joints) or poses (..., parts, 4, 4): a structured array (...) with the members of SelfClearance.
        """

    @property
    def robot(self) -> Robot:
        """The robot that is asked about."""

    @property
    def pairs(self) -> PartPairs:
        """The pairs of its parts that can meet."""

    def __reduce__(self) -> tuple[object, ...]: ...

    def __repr__(self) -> str: ...

def joint_gradients(robot: Robot, joints: _Array | Mapping[str, float] | None, result: MinDistanceResult | MinDistancesResult | MinDistancesPerPartResult | SelfDistanceResult, base: ArrayLike | None = None, ignore_limits: bool = False, rest: bool = False) -> NDArray[numpy.float64]:
    """
    How each least distance changes with the joints, metres per radian or metre: (..., joints) of MinDistance and MinDistances, (..., parts, joints) of MinDistancesPerPart, (pairs, joints) of SelfQuery. joints and base are those that were asked; ValueError if not, or if result is of another robot. A row is NaN where there is no gradient: no witness, distance 0, or the centre of a sphere.
    """
