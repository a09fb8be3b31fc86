"""Plays a depth camera of `perceive --live --ros2` in Cyclone DDS, and measures how old people are when they come.

It fails if fewer people come than frames could be processed, if one in twenty is older than the limit, or if they are not
where the camera's place on /tf_static has them.
"""

import argparse
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
from multiprocessing import Event, Process, Queue

from PIL import Image as Picture

import graph
from messages import CameraInfo, Header, Image, PoseArray, Quaternion, TFMessage, Time, Transform, TransformStamped, Vector3

WIDTH, HEIGHT = 640, 480
FOCAL = 615.0
DISTANCE = 3.0  # of the people [m]
FRAME = "camera_color_optical_frame"
# The camera stands in the map at x = 2 m, 1.2 m high, and looks along x: x of the image is -y, y of the image is -z.
MAST = (2.0, 0.0, 1.2)
TURN = (-0.5, 0.5, -0.5, 0.5)
SETTINGS = 'version = 1\n[camera]\nframe = "map"\nfrom_tf = true\n'
# Size, focal length and place are those on the graph.
PLACE = {
    "format": "moca-frames", "version": 1, "width": WIDTH, "height": HEIGHT, "fx": FOCAL, "fy": FOCAL,
    "cx": (WIDTH - 1) / 2, "cy": (HEIGHT - 1) / 2, "depth_scale": 0.001, "position": [0.0, 0.0, 0.0],
    "quaternion": [0.0, 0.0, 0.0, 1.0], "noise": {"constant": 0.001, "quadratic": 0.00416},
    "gravity": None, "stature": None,
}


def pictures(folder: pathlib.Path, count: int) -> list:
    """Colour images of a folder, cut to the camera's proportions, as bytes."""
    found = sorted(path for path in folder.iterdir() if path.suffix in (".jpg", ".png"))[:count]
    images = []
    for path in found:
        image = Picture.open(path).convert("RGB")
        scale = max(WIDTH / image.width, HEIGHT / image.height)
        # A person who stands upright in a high image stays whole in one that is wide.
        if image.height > image.width:
            scale = HEIGHT / image.height
        image = image.resize((round(scale * image.width), round(scale * image.height)))
        whole = Picture.new("RGB", (WIDTH, HEIGHT))
        whole.paste(image, ((WIDTH - image.width) // 2, (HEIGHT - image.height) // 2))
        images.append(list(whole.tobytes()))
    return images


def show(images: list, rate: float, over: Event, sent: Queue) -> None:
    """The camera: colour, depth and geometry at this rate [Hz]."""
    participant = graph.participant()
    names = ["color/camera_info", "color/image_raw", "aligned_depth_to_color/image_raw"]
    places = graph.writer(participant, "/tf_static", qos=graph.LATCHED)
    places.write(TFMessage([
        TransformStamped(Header(frame_id="map"), "camera_link", Transform(Vector3(*MAST))),
        TransformStamped(Header(frame_id="camera_link"), FRAME, Transform(rotation=Quaternion(*TURN))),
    ]))
    info, colour, depth = (graph.writer(participant, f"/camera/camera/{name}") for name in names)
    depths = list(int(1000 * DISTANCE).to_bytes(2, "little") * (WIDTH * HEIGHT))
    k = [FOCAL, 0.0, PLACE["cx"], 0.0, FOCAL, PLACE["cy"], 0.0, 0.0, 1.0]
    due, stamps = time.monotonic(), []
    while not over.is_set():
        due += 1.0 / rate
        time.sleep(max(0.0, due - time.monotonic()))
        stamp = time.time_ns()
        header = Header(Time.of(stamp), FRAME)
        info.write(CameraInfo(header, HEIGHT, WIDTH, "plumb_bob", [0.0] * 5, k))
        picture = images[len(stamps) % len(images)]
        colour.write(Image(header, HEIGHT, WIDTH, "rgb8", 0, 3 * WIDTH, picture))
        depth.write(Image(header, HEIGHT, WIDTH, "16UC1", 0, 2 * WIDTH, depths))
        stamps.append((stamp, time.time_ns()))
    sent.put(stamps)


def listen(over: Event, seen: Queue) -> None:
    """Somebody who waits for people: the stamp of each message, when it came, and the places of its joints along x."""
    participant = graph.participant()
    bodies = graph.reader(participant, "/body_joints")
    people = []
    while not over.is_set():
        for message in bodies.take(N=64):
            if not isinstance(message, PoseArray):
                continue  # the publisher has gone
            now = time.time_ns()
            joints = [pose.position.x for pose in message.poses if pose.position.x == pose.position.x]
            joints = joints if message.header.frame_id == "map" else []
            people.append((message.header.stamp.nanoseconds(), now, joints))
        time.sleep(0.0005)
    seen.put(people)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--perceive", required=True, help="the program, built with the feature ros2")
    parser.add_argument("--images", required=True, type=pathlib.Path, help="a folder of images of people")
    parser.add_argument("--duration", type=float, default=30.0, help="how long [s]; default 30")
    parser.add_argument("--rate", type=float, default=20.0, help="of the camera [Hz]; default 20")
    parser.add_argument("--limit", type=float, default=120.0, help="age of 95 in 100 [ms]; default 120")
    parser.add_argument("--priority", type=int, help="real-time priority of all processes, on a machine that does more")
    parser.add_argument("joints", nargs="+", help="options of perceive for joints and networks, after --")
    options = parser.parse_args()
    if options.priority:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(options.priority))
    images = pictures(options.images, 40)
    over, sent, seen = Event(), Queue(), Queue()
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "camera.json").write_text(json.dumps(PLACE))
        settings = pathlib.Path(folder) / "settings.toml"
        settings.write_text(SETTINGS)
        command = [options.perceive, folder, "--live", "--ros2", "--wait=20", "--json", "--quiet"]
        command += ["--settings", str(settings), *options.joints]
        perceive = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        parts = [Process(target=show, args=(images, options.rate, over, sent)), Process(target=listen, args=(over, seen))]
        for part in parts:
            part.start()
        time.sleep(options.duration)
        perceive.send_signal(signal.SIGINT)
        asked = time.monotonic()
        output, _ = perceive.communicate()
        stopped = time.monotonic() - asked
        over.set()
        stamps, people = sent.get(), seen.get()
        for part in parts:
            part.join()
    report = json.loads(output.splitlines()[-1])
    ages = sorted(1e-6 * (now - stamp) for stamp, now, _ in people) or [float("nan")]
    p50, p95, most = (ages[min(int(share * len(ages)), len(ages) - 1)] for share in (0.5, 0.95, 1.0))
    writing = sorted(1e-6 * (written - stamp) for stamp, written in stamps)
    live = report["live"]
    print(f"frames               {len(stamps)} shown, {report['frames']} processed, {len(people)} with people published")
    places = sorted(x for *_, joints in people for x in joints) or [float("nan")]
    place = places[len(places) // 2]
    print(f"joints a message     {len(places) / max(len(people), 1):.1f}, their median at x = {place:.2f} m in the map")
    print(f"not processed        {report['live']['late']} overtaken, {report['ros2']['unpaired']} unpaired")
    for topic in report["ros2"]["topics"]:
        print(f"  {topic['topic']:50} {topic['taken']} taken, {topic['lost']} lost, refused {topic['refused']}")
    print(f"age at the listener  p50 {p50:.0f}, p95 {p95:.0f}, max {most:.0f} ms")
    print(f"to the percept       p50 {live['latency']['median_us'] / 1e3:.0f}, p95 {live['latency_p95_ms']:.0f} ms")
    print(f"the camera's writing p50 {writing[len(writing) // 2]:.0f} ms, of this script alone")
    print(f"stopped within       {1e3 * stopped:.0f} ms")
    print(f"load average         {load:.2f} before, {os.getloadavg()[0]:.2f} after, on {os.cpu_count()} processors")
    wrong = []
    if not p95 <= options.limit:
        wrong.append(f"p95 {p95:.0f} ms, limit {options.limit} ms")
    if not abs(place - MAST[0] - DISTANCE) < 0.3:
        wrong.append(f"people at x = {place:.2f} m, in truth at {MAST[0] + DISTANCE} m")
    if len(people) < report["frames"]:
        wrong.append(f"{report['frames'] - len(people)} results lost")
    print("all is well" if not wrong else "\n".join(["wrong:", *wrong]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
