"""SoccerNet's annotated lines to cameras, and how well the cameras show these lines: JaC@5.

usage: soccernet_jac.py LINES DOC

LINES is a folder of SoccerNet's annotations, a JSON file a picture. DOC is a document whose first camera has taken the pictures
and has a base: lines alone give no base yet, so click a few landmarks, or let `touchline calibrate` find it.
"""

import os
import subprocess
import sys
import tempfile

import numpy as np
import touchline


def import_lines(folder, size):
    """SoccerNet's annotations as a document: a frame a picture, with clicks on lines."""
    with tempfile.TemporaryDirectory() as place:
        out = os.path.join(place, "lines.json")
        size = "x".join(map(str, size))
        program = [sys.executable, "-m", "touchline", "import", "--format", "soccernet-lines", folder, "--size", size]
        subprocess.run([*program, "-o", out], check=True)
        return touchline.load(out)


def lines_of(frame):
    """The clicks of a frame by their lines."""
    lines = {}
    for click in frame["clicks"]:
        if "line" in click:
            lines.setdefault(click["line"], []).append(click["image_px"])
    return {name: np.array(points) for name, points in lines.items()}


def main(folder, document):
    truth = touchline.load(document)
    base, field = truth.base(), truth.field
    scores = []
    for frame in import_lines(folder, base.image_size_px).frames:
        try:
            camera = touchline.solve_frame(base, frame["clicks"], field).camera
            scores.append(touchline.jac(camera, lines_of(frame), field))
        except touchline.Error as error:
            print(f"{frame['image']}: {error}", file=sys.stderr)
            scores.append(0.0)
    print(f"JaC@5 {np.mean(scores):.3f} of {len(scores)} pictures")


if __name__ == "__main__":
    main(*sys.argv[1:])
