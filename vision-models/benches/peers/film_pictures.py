"""Draws what was found in a film, for film.sh and the book's page on people on film.

python film_pictures.py FOLDER CAMERA OUTPUT.jpg

Some images of the film side by side, with BlazePose's landmarks of that camera, and REBA by all cameras below.
"""

import csv
import json
import sys
from pathlib import Path

import cv2
import numpy as np

# Images that are shown, the height of a picture and around it (pixels).
SHOWN, HEIGHT, MARGIN = (8, 34, 60, 86), 360, 12
# Landmarks that are joined: trunk and head, then the left and the right limbs.
TRUNK = [(11, 12), (23, 24), (11, 23), (12, 24), (7, 0), (0, 8)]
LEFT = [(11, 13), (13, 15), (23, 25), (25, 27), (27, 29), (29, 31)]
RIGHT = [(first + 1, second + 1) for first, second in LEFT]
COLOURS = [(TRUNK, (255, 255, 255)), (LEFT, (0, 200, 255)), (RIGHT, (255, 170, 0))]
SURE = 0.5


def drawn(image, person):
    """The image with a skeleton, whose lines are as thick as the person is large."""
    points, seen = person[:, :2], np.minimum(person[:, 3], person[:, 4]) > SURE
    thick = max(2, round(np.ptp(points[:, 1]) / 130))
    for limbs, colour in COLOURS:
        for one, other in limbs:
            if seen[one] and seen[other]:
                ends = [tuple(map(int, points[index].round())) for index in (one, other)]
                cv2.line(image, *ends, colour, thick, cv2.LINE_AA)
    return image


def main():
    folder, camera, output = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    people = [json.loads(line) for line in (folder / f"film_{camera}.jsonl").read_text().splitlines()]
    people = [np.array(found[0]) if found else None for found in people]
    with open(folder / "film_four.csv") as file:
        rows = list(csv.DictReader(file))
    scores = {round(float(row["time_s"]), 3): row for row in rows}
    rate = (len(rows) - 1) / (float(rows[-1]["time_s"]) - float(rows[0]["time_s"]))
    everywhere = np.concatenate([person[:, :2] for person in people if person is not None])
    left, top = np.maximum(everywhere.min(0) - MARGIN, 0).astype(int)
    right, bottom = (everywhere.max(0) + MARGIN).astype(int)
    pictures = []
    for index in SHOWN:
        image = cv2.imread(str(folder / "frames" / camera / f"{index:04}.png"))
        if people[index] is not None:
            image = drawn(image, people[index])
        image = image[top:bottom, left:right]
        image = cv2.resize(image, (round(image.shape[1] * HEIGHT / image.shape[0]), HEIGHT), interpolation=cv2.INTER_AREA)
        below = np.full((34, image.shape[1], 3), 255, np.uint8)
        row = scores.get(round(index / rate, 3))
        text = f"{index / rate:.2f} s: REBA {row['reba']}" if row else f"{index / rate:.2f} s"
        cv2.putText(below, text, (6, 24), cv2.FONT_HERSHEY_SIMPLEX, 0.55, (0, 0, 0), 1, cv2.LINE_AA)
        pictures.append(np.vstack([image, below]))
    cv2.imwrite(output, np.hstack(pictures), [cv2.IMWRITE_JPEG_QUALITY, 75])


main()
