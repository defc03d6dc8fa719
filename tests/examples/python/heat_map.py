"""Where the players were, seen from above: a video, and a table of boxes around players in its frames.

usage: heat_map.py VIDEO_OR_DOC BOXES.csv OUT.png

BOXES.csv has the columns frame (from 0), x, y, width, height (px). The camera is found without a click.
"""

import os
import sys

import cv2
import numpy as np
import touchline

CELL_M = 0.5
BLUR_M = 2.0


def heat_map(document, boxes):
    """How often each cell of the field was trodden: (rows from the far touchline, columns from the left)."""
    field = document.field
    feet = []
    for number, x, y, width, height in boxes:
        camera = document.camera(int(number))
        if camera is not None:
            feet.append(touchline.unproject(camera, [x + width / 2, y + height])[:2])
    seen = touchline.interchange.to_pitch(np.array(feet), field, "top_left")
    shape = int(field.width_m / CELL_M), int(field.length_m / CELL_M)
    counts, _, _ = np.histogram2d(seen[:, 1], seen[:, 0], shape, ((0, field.width_m), (0, field.length_m)))
    return cv2.GaussianBlur(counts, (0, 0), BLUR_M / CELL_M)


def main(source, boxes, out):
    document = touchline.load(source) if os.path.isdir(source) or source.endswith(".json") else touchline.calibrate(source)
    heat = heat_map(document, np.loadtxt(boxes, delimiter=",", skiprows=1, ndmin=2))
    cv2.imwrite(out, cv2.applyColorMap(np.uint8(255 * heat / max(heat.max(), 1e-9)), cv2.COLORMAP_INFERNO))


if __name__ == "__main__":
    main(*sys.argv[1:])
