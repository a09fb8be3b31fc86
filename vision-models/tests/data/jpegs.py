"""JPEG files as Pillow writes them, for tests/it/jpegs.rs: of several kinds, and one that was taken upright.

python jpegs.py (Pillow 13)
"""
import io, json, base64
from PIL import Image

def picture(width, height, mode="RGB"):
    image = Image.new("RGB", (width, height))
    image.putdata([((7 * x + y) % 256, (3 * y) % 256, (x * y) % 256) for y in range(height) for x in range(width)])
    return image.convert(mode)

files = {}
for name, size, mode, options in [
    ("baseline", (47, 33), "RGB", {}),
    ("optimised", (47, 33), "RGB", {"optimize": True}),
    ("progressive", (47, 33), "RGB", {"progressive": True}),
    ("progressive grey", (47, 33), "L", {"progressive": True}),
    ("grey", (16, 40), "L", {"quality": 20}),
    ("full chroma", (33, 17), "RGB", {"subsampling": 0}),
    ("half chroma", (33, 17), "RGB", {"subsampling": 1}),
    ("restarts", (64, 48), "RGB", {"restart_marker_rows": 1}),
    ("cmyk", (24, 24), "CMYK", {}),
    ("narrow", (1, 200), "RGB", {}),
    ("wide", (200, 1), "L", {}),
]:
    file = io.BytesIO()
    picture(*size, mode).save(file, "JPEG", **options)
    files[name] = base64.b16encode(file.getvalue()).decode()
exif = Image.Exif()
exif[0x0112] = 6
file = io.BytesIO()
picture(40, 24).save(file, "JPEG", exif=exif, quality=95)
files["turned"] = base64.b16encode(file.getvalue()).decode()
print(json.dumps(files, indent=0))
