"""Fills corpus/ with small seeds, from the checkpoints of ../tests/data.

Needs pillow and numpy:
    python seeds.py
"""
import io
import pathlib

import numpy
from PIL import Image

here = pathlib.Path(__file__).parent
data = here.parent / "tests" / "data"
MAGIC = 15  # bytes of the magic number's pickle


def seed(target, name, content):
    folder = here / "corpus" / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content)


for name in ["wrapped.pth", "protocol5.pth", "compressed.pth", "hostile.pth"]:
    seed("archive", name, (data / name).read_bytes())
stream = (data / "stream.pth").read_bytes()
seed("stream", "stream", stream[MAGIC:])
# The object's pickle is the fourth of the stream.
parts = stream.split(b".\x80\x02")
seed("pickle", "object", parts[3])
import zipfile

for name in ["wrapped.pth", "protocol5.pth", "hostile.pth"]:
    with zipfile.ZipFile(data / name) as archive:
        pickle = next(archive.read(n) for n in archive.namelist() if n.endswith("data.pkl"))
    seed("pickle", name, pickle[:-1])
safetensors = (data / "plain.safetensors").read_bytes()
seed("safetensors", "plain", safetensors[8 : 8 + int.from_bytes(safetensors[:8], "little")])
seed("safetensors", "one", b'{"__metadata__":{"a":"b"},"t":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}}')
seed("svm", "two", b"linear-svm 1\nclasses 2\nsmooth\ndrilled\nplanes 1 features 2\n1e-1 1e0 -2.5e-300\n")
seed("svm", "three", b"linear-svm 1\nclasses 3\na\nb\nc\nplanes 3 features 1\n1 2\n3 4\n5 6\n")
seed("labels", "numbered", b"1 DeliverObject\n2 Walking\nclip.avi,2\n")
seed("labels", "plain", b"Deliver Object\nWalking With Drill\n")
seed("labels", "clips", b"name,label\nCID01_SID02_VID03.avi,3\nclip Walking\n")
pixels = numpy.arange(5 * 6 * 3, dtype=numpy.uint8).reshape(5, 6, 3)
for name, image, kind in [
    ("rgb.png", Image.fromarray(pixels), "PNG"),
    ("grey.png", Image.fromarray(pixels[..., 0]), "PNG"),
    ("palette.png", Image.fromarray(pixels).convert("P"), "PNG"),
    ("rgb.jpg", Image.fromarray(pixels), "JPEG"),
    ("grey.jpg", Image.fromarray(pixels[..., 0]), "JPEG"),
]:
    buffer = io.BytesIO()
    image.save(buffer, kind)
    seed("image", name, buffer.getvalue())
depth = numpy.arange(30, dtype=numpy.uint16).reshape(5, 6) * 100
buffer = io.BytesIO()
Image.fromarray(depth).save(buffer, "PNG")
seed("depth", "small.png", buffer.getvalue())
joint = b"1.5,2e2,0.7"
for name, joints in [("body25", 25), ("coco18", 18)]:
    person = b'{"person_id":[-1],"pose_keypoints_2d":[' + b",".join([joint] * joints) + b"]}"
    seed("joints", name, b'{"version":1.3,"people":[' + person + b"," + person + b"]}")
mark = b'{"x":0.5,"y":0.25,"z":-0.1,"visibility":0.9}'
marks = b"[" + b",".join([mark] * 33) + b"]"
seed("joints", "mediapipe", b'[{"landmarks":[' + marks + b'],"worldLandmarks":[' + marks + b"]}]")
pairs, scores = b",".join([b"[1,2]"] * 17), b",".join([b"0.9"] * 17)
instance = b'{"keypoints":[' + pairs + b'],"keypoint_scores":[' + scores + b"]}"
seed("joints", "mmpose", b'{"instance_info":[{"frame_id":1,"instances":[' + instance + b"]}]}")
for name in ["operators", "blaze_detector"]:
    seed("tensorflow_lite", name, (data / f"{name}.tflite").read_bytes())
