"""Bags: the same map by the command, by `replay`, and by arrays that others read from the bag."""

import io
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from ellipsoid_slam import BagError, Box, Camera, ObjectMap, ObjectSlam, Pose, SettingsError, replay
from mcap_ros2.reader import read_ros2_messages
from mcap_ros2.writer import Writer
from PIL import Image
from suitcase import CAMERA, looks


def test_a_bag_gives_the_bytes_that_the_command_writes(
    desk: Path, desk_map: ObjectMap, program: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    command: list[str | Path] = [program, "replay", desk, "--output", out, "--no-report", "--no-images"]
    subprocess.run(command, check=True, capture_output=True)
    assert desk_map.to_json() == (out / "map.json").read_text()


def test_messages_read_by_others_give_the_same_map(desk: Path, desk_map: ObjectMap) -> None:
    slam = ObjectSlam()
    for message in read_ros2_messages(desk):
        hear(slam, message.channel.topic, message.ros_msg)
    slam.finish()
    assert slam.map.to_json() == desk_map.to_json()


def hear(slam: ObjectSlam, topic: str, ros: Any) -> None:
    """Hands over a message of the demo bag."""
    if topic in ("/tf", "/tf_static"):
        for each in ros.transforms:
            t, names = each.transform, (each.header.frame_id, each.child_frame_id)
            pose = Pose(xyz(t.translation), xyzw(t.rotation))
            slam.add_transform(stamp_ns(each), pose, *names, static=topic == "/tf_static")
    elif topic == "/odom":
        pose = pose_of(ros.pose.pose)
        covariance = np.reshape(ros.pose.covariance, (6, 6))
        odom, base = ros.header.frame_id, ros.child_frame_id
        slam.add_odometry(stamp_ns(ros), pose, covariance, frame_id=odom, child_frame_id=base)
    elif topic.endswith("camera_info"):
        slam.add_camera(stamp_ns(ros), camera_of(ros), ros.header.frame_id)
    elif topic.endswith("compressedDepth"):
        slam.add_depth(stamp_ns(ros), depth_of(ros), ros.header.frame_id)
    elif topic == "/detections":
        slam.add_boxes(stamp_ns(ros), boxes_of(ros), ros.header.frame_id)


def test_frames_of_a_bag_give_the_same_map(desk: Path, tmp_path: Path) -> None:
    bag = tmp_path / "suitcase.mcap"
    write_suitcase(bag, schemas_of(desk))
    replayed = replay(bag)
    assert (replayed.frames, replayed.keyframes, replayed.messages) == (6, 6, 24)
    assert [found.label for found in replayed.map] == ["suitcase"]

    slam = ObjectSlam()
    frame: dict[str, Any] = {}
    for message in read_ros2_messages(bag):
        frame[message.channel.topic] = message.ros_msg
        if message.channel.topic == "/detections":
            slam.see(
                stamp_ns(frame["/detections"]),
                camera_of(frame["/camera/camera_info"]),
                pose_of(frame["/odom"].pose.pose),
                depth_of(frame["/camera/depth/compressedDepth"]),
                boxes_of(frame["/detections"]),
            )
    slam.finish()
    assert slam.map.to_json() == replayed.map.to_json()
    assert slam.trajectory == replayed.slam.trajectory


def stamp_ns(ros: Any) -> int:
    return int(ros.header.stamp.sec) * 1_000_000_000 + int(ros.header.stamp.nanosec)


def xyz(v: Any) -> tuple[float, float, float]:
    return (v.x, v.y, v.z)


def xyzw(q: Any) -> tuple[float, float, float, float]:
    return (q.x, q.y, q.z, q.w)


def pose_of(ros: Any) -> Pose:
    return Pose(xyz(ros.position), xyzw(ros.orientation))


def camera_of(ros: Any) -> Camera:
    fx, _, cx, _, fy, cy, *_ = ros.k
    return Camera(ros.width, ros.height, fx, fy, cx, cy, tuple(ros.d))


def depth_of(ros: Any) -> npt.NDArray[np.uint16]:
    # A header of 12 bytes comes before the PNG.
    return np.asarray(Image.open(io.BytesIO(bytes(ros.data)[12:]))).astype(np.uint16)


def boxes_of(ros: Any) -> list[Box]:
    boxes = []
    for each in ros.detections:
        center, half_x, half_y = each.bbox.center.position, 0.5 * each.bbox.size_x, 0.5 * each.bbox.size_y
        corners = (center.x - half_x, center.y - half_y, center.x + half_x, center.y + half_y)
        first, *others = [(r.hypothesis.class_id, r.hypothesis.score) for r in each.results]
        boxes.append(Box(corners, *first, dict(others)))
    return boxes


def schemas_of(bag: Path) -> dict[str, str]:
    return {m.schema.name: m.schema.data.decode() for m in read_ros2_messages(bag)}


def write_suitcase(path: Path, schemas: dict[str, str], base: str = "camera") -> None:
    """A bag of a camera that is its own base, unless that has another name."""
    with path.open("wb") as file:
        writer = Writer(file)
        for topic, name, stamp, message in suitcase_messages(base):
            schema = writer.register_msgdef(name, schemas[name])
            writer.write_message(topic, schema, message, stamp, stamp)
        writer.finish()  # type: ignore[no-untyped-call]


def suitcase_messages(base: str) -> Iterator[tuple[str, str, int, dict[str, Any]]]:
    for look in looks():
        stamp = {"sec": look.stamp_ns // 10**9, "nanosec": look.stamp_ns % 10**9}
        header = {"stamp": stamp, "frame_id": "camera"}
        (x, y, z), (qx, qy, qz, qw) = look.odom_from_camera.position, look.odom_from_camera.orientation
        pose = {"position": {"x": x, "y": y, "z": z}, "orientation": {"x": qx, "y": qy, "z": qz, "w": qw}}
        k = [CAMERA.fx, 0.0, CAMERA.cx, 0.0, CAMERA.fy, CAMERA.cy, 0.0, 0.0, 1.0]
        size = {"width": CAMERA.width, "height": CAMERA.height}
        png = io.BytesIO()
        Image.fromarray(look.depth_mm).save(png, "PNG")
        x_min, y_min, x_max, y_max = look.box.corners
        bbox = {
            "center": {"position": {"x": (x_min + x_max) / 2, "y": (y_min + y_max) / 2}},
            "size_x": x_max - x_min,
            "size_y": y_max - y_min,
        }
        results = [{"hypothesis": {"class_id": look.box.label, "score": look.box.score}}]
        yield (
            "/camera/camera_info",
            "sensor_msgs/msg/CameraInfo",
            look.stamp_ns,
            {"header": header, **size, "distortion_model": "plumb_bob", "k": k},
        )
        yield (
            "/odom",
            "nav_msgs/msg/Odometry",
            look.stamp_ns,
            {"header": {**header, "frame_id": "odom"}, "child_frame_id": base, "pose": {"pose": pose}},
        )
        yield (
            "/camera/depth/compressedDepth",
            "sensor_msgs/msg/CompressedImage",
            look.stamp_ns,
            {"header": header, "format": "16UC1; compressedDepth png", "data": bytes(12) + png.getvalue()},
        )
        yield (
            "/detections",
            "vision_msgs/msg/Detection2DArray",
            look.stamp_ns,
            {"header": header, "detections": [{"header": header, "bbox": bbox, "results": results}]},
        )


def test_what_a_bag_lacks_is_said(desk: Path, tmp_path: Path) -> None:
    with pytest.raises(BagError, match="none.mcap"):
        replay(tmp_path / "none.mcap")
    (tmp_path / "text.mcap").write_text("hello")
    with pytest.raises(BagError, match="text.mcap"):
        replay(tmp_path / "text.mcap")
    with pytest.raises(BagError, match="/nowhere"):
        replay(desk, topics={"depth": "/nowhere"})
    with pytest.raises(SettingsError, match="dpeth"):
        replay(desk, topics={"dpeth": "/depth"})


def test_a_bag_without_a_usable_pose_is_told_why(desk: Path, tmp_path: Path) -> None:
    bag = tmp_path / "base.mcap"
    # Odometry is of a base, and nothing says where the camera is on it.
    write_suitcase(bag, schemas_of(desk), base="base_link")
    with pytest.raises(BagError, match="no depth image could be paired with boxes and a pose: .*base_link"):
        replay(bag)
    assert replay(bag, {"sync.camera_pose": "0,0,0,0,0,0"}).keyframes == 6


def test_topics_are_named_by_role(desk: Path, desk_map: ObjectMap) -> None:
    named = replay(desk, topics={"detections": "/detections", "odometry": "/odom"})
    assert named.map.to_json() == desk_map.to_json()
    with pytest.raises(BagError, match="topics under /ground_truth/ are never input"):
        replay(desk, topics={"detections": "/ground_truth/detections"})


def test_others_go_on_while_a_bag_is_replayed(desk: Path) -> None:
    done = threading.Event()

    def work() -> None:
        replay(desk)
        done.set()

    turns = 0
    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        turns += 1
        time.sleep(0.002)
    thread.join()
    assert turns > 20, "the interpreter was kept"


def test_a_replay_can_be_interrupted(desk: Path) -> None:
    def seconds(run: Callable[[], object]) -> float:
        started = time.monotonic()
        run()
        return time.monotonic() - started

    def interrupted() -> None:
        signal.setitimer(signal.ITIMER_REAL, 0.1 * whole)
        with pytest.raises(KeyboardInterrupt):
            replay(desk)

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    whole = seconds(lambda: replay(desk))
    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        assert seconds(interrupted) < 0.7 * whole, "it went on to the bag's end"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def test_threads_that_share_a_run_take_turns() -> None:
    slam = ObjectSlam()
    errors: list[BaseException] = []

    def ask() -> None:
        try:
            for _ in range(50):
                slam.objects, slam.map, slam.trajectory, slam.pose
        except BaseException as why:
            errors.append(why)

    asking = [threading.Thread(target=ask) for _ in range(3)]
    for thread in asking:
        thread.start()
    for look in looks():
        slam.see(look.stamp_ns, CAMERA, look.odom_from_camera, look.depth_m, [look.box])
    for thread in asking:
        thread.join()
    slam.finish()
    assert not errors and len(slam.objects) == 1
