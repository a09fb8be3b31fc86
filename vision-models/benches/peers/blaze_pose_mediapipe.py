"""Landmarks by MediaPipe's graph for processors, without smoothing, for blaze_pose.sh.

python blaze_pose_mediapipe.py RATE OUTPUT IMAGE...
python blaze_pose_mediapipe.py RATE OUTPUT --changed IMAGE...

Writes the landmarks of each image. Beside OUTPUT, a file that ends in `.regions.json` has the region in which they were
searched: centre x, y, side (pixels), angle (rad).
With rate 0 the detector looks at every image. With --changed one pixel in the middle of the first image is a level off:
what that changes in the images after it is how far MediaPipe agrees with itself. `mediapipe.solutions` is not used: in static mode its landmarks are up to
three pixels from what the graph that it names makes of the same region.
"""

import json
import os
import sys
from pathlib import Path

import cv2
import mediapipe as mp
from mediapipe.python import packet_creator, packet_getter
from mediapipe.python._framework_bindings import resource_util

GRAPH = """
input_stream: "image"
output_stream: "landmarks"
output_stream: "detected"
output_stream: "next"
node {
  calculator: "ConstantSidePacketCalculator"
  output_side_packet: "PACKET:0:complexity"
  output_side_packet: "PACKET:1:smooth"
  output_side_packet: "PACKET:2:follow"
  node_options: {
    [type.googleapis.com/mediapipe.ConstantSidePacketCalculatorOptions]: {
      packet { int_value: 1 } packet { bool_value: false } packet { bool_value: %s }
    }
  }
}
node {
  calculator: "PoseLandmarkCpu"
  input_side_packet: "MODEL_COMPLEXITY:complexity"
  input_side_packet: "SMOOTH_LANDMARKS:smooth"
  input_side_packet: "USE_PREV_LANDMARKS:follow"
  input_stream: "IMAGE:image"
  output_stream: "LANDMARKS:landmarks"
  output_stream: "ROI_FROM_DETECTION:detected"
  output_stream: "ROI_FROM_LANDMARKS:next"
}
"""


def main():
    rate, output, files = float(sys.argv[1]), sys.argv[2], sys.argv[3:]
    changed = files[0] == "--changed"
    files = files[changed:]
    resource_util.set_resource_dir(os.path.dirname(os.path.dirname(mp.__file__)))
    graph = mp.CalculatorGraph(graph_config=GRAPH % ("true" if rate else "false"))
    seen = {"landmarks": [], "detected": [], "next": []}
    for name, packets in seen.items():
        keep = lambda _, packet, packets=packets: packets.append(packet_getter.get_proto(packet))
        graph.observe_output_stream(name, keep, False)
    graph.start_run()
    people, regions, expected = [], [], []
    for number, file in enumerate(files):
        image = cv2.cvtColor(cv2.imread(file), cv2.COLOR_BGR2RGB)
        rows, columns, _ = image.shape
        if changed and number == 0:
            image[rows // 2, columns // 2] ^= 1
        packet = packet_creator.create_image_frame(image_format=mp.ImageFormat.SRGB, data=image)
        # Time stamps do not begin with zero, which the graph treats as missing.
        graph.add_packet_to_input_stream("image", packet.at(int((number + 1) * 1e6 / (rate or 25))))
        for packets in seen.values():
            packets.clear()
        graph.wait_until_idle()
        people.append([[point.x * columns, point.y * rows] for found in seen["landmarks"] for point in found.landmark])
        pixels = lambda found: [[one.x_center * columns, one.y_center * rows, one.width * columns, one.rotation]
                                for one in found]
        regions += (pixels(seen["detected"]) or expected or [None])[:1]
        expected = pixels(seen["next"])
    Path(output).write_text(json.dumps(people))
    Path(output).with_suffix(".regions.json").write_text(json.dumps(regions))


main()
