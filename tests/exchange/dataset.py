"""An exported dataset as its users see it: the guide's example, the loader, the recipes; and README's commands.

usage: dataset.py TOUCHLINE PYTHON

PYTHON is one that has numpy and OpenCV alone: the guide's example and the recipes run with it. The demo match is exported; the example draws
the field on a frame, and the loader's overlay is compared with the program's own.
"""

import glob
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

import cv2
import jsonschema
import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
ALLOWED_PX = 0.1


def run(*command, code=0, **options):
    ran = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert code is None or ran.returncode == code, f"{command}: {ran.returncode}\n{ran.stdout[-2000:]}{ran.stderr}"
    return ran


def blocks(page, word):
    """The Python blocks of a page that hold a word."""
    with open(os.path.join(ROOT, page), encoding="utf-8") as file:
        found = re.findall(r"```python\n(.*?)```", file.read(), re.S)
    return [block for block in found if word in block]


def distance(point, line):
    """How far a point lies from a polyline."""
    a, b = line[:-1], line[1:]
    known = np.isfinite(a).all(1) & np.isfinite(b).all(1)
    a, b = a[known], b[known]
    along = b - a
    share = np.clip(((point - a) * along).sum(1) / np.maximum((along**2).sum(1), 1e-12), 0, 1)
    return np.linalg.norm(a + share[:, None] * along - point, axis=1).min()


def manifest(folder):
    """Every file is listed with its hash, and nothing else lies there."""
    with open(os.path.join(folder, "manifest.sha256"), encoding="utf-8") as file:
        listed = dict(reversed(line.rstrip("\n").split("  ", 1)) for line in file)
    files = [name for name in glob.glob("**", root_dir=folder, recursive=True) if os.path.isfile(os.path.join(folder, name))]
    assert set(files) == set(listed) | {"manifest.sha256"}
    for name, wanted in listed.items():
        with open(os.path.join(folder, name), "rb") as file:
            assert hashlib.sha256(file.read()).hexdigest() == wanted, name


def schema(folder):
    with open(os.path.join(folder, "schema.json"), encoding="utf-8") as file:
        validator = jsonschema.Draft202012Validator(json.load(file))
    for name in ("dataset.json", "undistorted/dataset.json"):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            errors = list(validator.iter_errors(json.load(file)))
        assert not errors, errors[:3]


def overlays(touchline, folder, data, work):
    """The largest distance of the points of lines that the program projects from the loader's lines, px."""
    path = os.path.join(work, "lines")
    document = os.path.join(folder, "dataset.json")
    run(touchline, "export", document, "--format", "labelme", "--projected", "-o", path)
    largest, points = 0.0, 0
    for index in range(len(data)):
        stem = os.path.splitext(os.path.basename(data.images[index]))[0]
        with open(os.path.join(path, stem + ".json"), encoding="utf-8") as file:
            shapes = json.load(file)["shapes"]
        lines = data.overlay(index)
        for shape in shapes:
            if shape["label"] in lines:
                for point in shape["points"]:
                    largest = max(largest, distance(np.array(point), lines[shape["label"]]))
                    points += 1
    assert points > 50 * len(data), points
    return largest


def plain_environment(**entries):
    """The environment of a reader, to whom no path leads that the page does not name."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return {**environment, **entries}


def example(python, folder):
    """The guide's example, run as it stands."""
    (code,) = blocks("assets/guide/library.md", "data.overlay(0)")
    assert len([line for line in code.splitlines() if line.strip()]) <= 15
    work = os.path.dirname(folder)
    run(python, "-c", code, cwd=work, env=plain_environment())
    return cv2.imread(os.path.join(work, "overlay.png"))


def numpy_alone(python, folder):
    """The loader needs nothing but numpy."""
    code = (
        "import sys; sys.modules['cv2'] = None; import touchline_dataset as t; d = t.load(%r); "
        "print(len(d), len(d.overlay(0)) > 0)" % folder
    )
    said = run(python, "-c", code, env={**os.environ, "PYTHONPATH": folder}).stdout.split()
    assert int(said[0]) > 0 and said[1] == "True", said


SHOT_SIZE = (1920, 1080)
SHOT_FRAMES = 12
SHOT_DEGREES_A_FRAME = 0.1
SHOT_ZOOM = 1.3
SHOT_ALLOWED_DEGREES = 0.03


def shot_rotation(frame, first):
    """The rotation of a frame of the shot: panned about the camera's vertical axis, which stands upright in the world."""
    angle = np.array([[0.0], [0.0], [np.deg2rad(SHOT_DEGREES_A_FRAME * frame)]])
    return first @ cv2.Rodrigues(angle)[0]


def write_shot(data, work):
    """A shot in FIFA's arrays: a picture of the dataset without its lens, panned a tenth of a degree a frame.

    The picture is shown closer than it was taken, so that the pan does not leave it. Returns the rotations of its frames.
    """
    picture = cv2.imread(data.picture(0))
    first, translation, matrix, _ = data.opencv(0)
    width, height = SHOT_SIZE
    focal_px = SHOT_ZOOM * matrix[0, 0] * width / picture.shape[1]
    K = np.array([[focal_px, 0, (width - 1) / 2], [0, focal_px, (height - 1) / 2], [0, 0, 1]])
    rotations = [shot_rotation(frame, first) for frame in range(SHOT_FRAMES)]
    video = cv2.VideoWriter(os.path.join(work, "SHOT.mp4"), cv2.VideoWriter_fourcc(*"mp4v"), 25, SHOT_SIZE)
    assert video.isOpened()
    for turned in rotations:
        video.write(cv2.warpPerspective(picture, K @ turned @ first.T @ np.linalg.inv(matrix), SHOT_SIZE, flags=cv2.INTER_LINEAR))
    video.release()
    np.savez(
        os.path.join(work, "SHOT.npz"),
        K=np.repeat(K[None], SHOT_FRAMES, 0),
        k=np.zeros((SHOT_FRAMES, 5)),
        R=first[None],
        t=np.asarray(translation, dtype=float).reshape(1, 3),
    )
    return rotations


def worst_turn(path, rotations):
    """The largest angle between the rotations of a file and others, degrees."""
    with np.load(path, allow_pickle=False) as arrays:
        assert arrays["R"].shape == (SHOT_FRAMES, 3, 3), arrays["R"].shape
        turns = [cv2.Rodrigues(found @ wanted.T)[0] for found, wanted in zip(arrays["R"], rotations)]
    return np.rad2deg(max(np.linalg.norm(turn) for turn in turns))


def recipes(touchline, python, folder):
    """Every Python block of the recipes runs after the command above it."""
    with open(os.path.join(ROOT, "assets", "recipes.md"), encoding="utf-8") as file:
        page = file.read()
    work = os.path.dirname(folder)
    for kind, code in re.findall(r"```(sh|python)\n(.*?)```", page, re.S):
        environment = plain_environment(PATH=os.path.dirname(touchline) + os.pathsep + os.environ["PATH"])
        command = ["sh", "-ec", code] if kind == "sh" else [python, "-c", code]
        run(*command, cwd=work, env=environment)


# What a command of README's table names that is not here: a video, a season, minutes of work.
NOT_HERE = ("match.mp4", "FRAMES_OR_VIDEO_OR_DIR", " plan", " shard", " collect", " synth")


def readme(touchline, demo, work):
    """README's table of commands on the demo match, each as it stands, in the order of the table."""
    with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as file:
        commands = re.findall(r"`(touchline [^`]+)`", file.read().split("## Commands")[1].split("\n## ")[0])
    shutil.copytree(demo, os.path.join(work, "DIR"))
    run(touchline, "export", demo, "--format", "soccernet", "-o", os.path.join(work, "cameras"), code=None)
    run(touchline, "export", demo, "--format", "json", "-o", os.path.join(work, "truth.json"))
    environment = plain_environment(PATH=os.path.dirname(touchline) + os.pathsep + os.environ["PATH"])
    here = [command for command in commands if not any(word in command for word in NOT_HERE) and len(command.split()) > 1]
    for command in here:
        # Of frames that are seconds apart none is reached from another one, which is said.
        code = 1 if command.startswith("touchline track ") else 0
        run("sh", "-ec", command, cwd=work, env=environment, code=code)
    return len(here)


def main():
    touchline, python = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    with tempfile.TemporaryDirectory() as work:
        folder = os.path.join(work, "out")
        demo = os.path.join(ROOT, "projects", "demo")
        run(touchline, "export", demo, "--dataset", folder, "--split", "80/10/10", "--status", "reference,suggested,draft", "--undistorted")
        manifest(folder)
        schema(folder)
        sys.path.insert(0, folder)
        import touchline_dataset

        assert os.path.dirname(touchline_dataset.__file__) == folder, "the loader in the dataset"
        data = touchline_dataset.load(folder)
        assert len(data) > 0 and set(data.split) <= {"train", "validation", "test"} and all(data.label)
        off = overlays(touchline, folder, data, work)
        print("%-12s %-42s %.1e px" % ("dataset", "touchline_dataset.py, lines of %d frames" % len(data), off))
        assert off < ALLOWED_PX
        picture, drawn = cv2.imread(data.picture(0)), example(python, folder)
        changed = np.argwhere((picture != drawn).any(axis=2))[:, ::-1] + 0.5
        lines = list(data.overlay(0).values())
        far = max(min(distance(pixel, line) for line in lines) for pixel in changed[:: max(1, len(changed) // 500)])
        print("%-12s %-42s %.1f px from the lines" % ("guide", "OpenCV, %d px drawn" % len(changed), far))
        assert len(changed) > 500 and far < 2.5
        numpy_alone(python, folder)
        plain = touchline_dataset.load(os.path.join(folder, "undistorted"))
        assert len(plain) == len(data) and not plain.k1.any() and os.path.exists(plain.picture(0))
        commands = os.path.join(work, "readme")
        os.mkdir(commands)
        print("%-12s %-42s" % ("readme", "%d commands of the table, as they stand" % readme(touchline, demo, commands)))
        rotations = write_shot(plain, work)
        recipes(touchline, python, folder)
        off = worst_turn(os.path.join(work, "SHOT_tracked.npz"), rotations)
        print("%-12s %-42s %.4f degrees" % ("recipes", "run; the shot of FIFA's arrays, its rotations", off))
        assert off < SHOT_ALLOWED_DEGREES


if __name__ == "__main__":
    main()
