"""SoccerNet's measure of cameras (JaC), written again from the definition of its `evaluate_camera.py`, beside `touchline evaluate`.

A camera's classes of lines are projected as polylines, cut at the picture's border; a class that is annotated and shown counts
as found where every annotated point is nearer than t px to its polyline. JaC@t = TP / (TP + FP + FN); of the annotation and the same
turned by half a turn the better counts, for each t by itself.
"""

import json
import os
import subprocess
import tempfile

import numpy as np

WIDTH, HEIGHT = 960, 540
FRAMES = 200
HALF_LENGTH, HALF_WIDTH = 52.5, 34.0
GOAL, GOAL_HEIGHT = 3.66, 2.44
RADIUS = 9.15


def pitch(step_m):
    """Polylines of the task's classes in its world (x right, y towards the camera, z down), a point every `step_m`."""
    lines = {}

    def straight(name, start, end):
        start, end = np.array(start, float), np.array(end, float)
        count = int(np.ceil(np.linalg.norm(end - start) / step_m))
        lines[name] = start + np.linspace(0, 1, count + 1)[:, None] * (end - start)

    def arc(name, centre, begin, end):
        count = int(np.ceil((end - begin) * RADIUS / step_m))
        angles = np.linspace(begin, end, count + 1)
        lines[name] = np.column_stack([centre + RADIUS * np.cos(angles), RADIUS * np.sin(angles), 0 * angles])

    straight("Side line top", (-HALF_LENGTH, -HALF_WIDTH, 0), (HALF_LENGTH, -HALF_WIDTH, 0))
    straight("Side line bottom", (-HALF_LENGTH, HALF_WIDTH, 0), (HALF_LENGTH, HALF_WIDTH, 0))
    straight("Middle line", (0, -HALF_WIDTH, 0), (0, HALF_WIDTH, 0))
    arc("Circle central", 0, 0, 2 * np.pi)
    for side, sign in (("left", -1), ("right", 1)):
        goal_line = sign * HALF_LENGTH
        straight("Side line " + side, (goal_line, -HALF_WIDTH, 0), (goal_line, HALF_WIDTH, 0))
        for size, half, depth in (("Big", 20.16, 16.5), ("Small", 9.16, 5.5)):
            front = goal_line - sign * depth
            for end, y in (("top", -half), ("bottom", half)):
                straight("%s rect. %s %s" % (size, side, end), (goal_line, y, 0), (front, y, 0))
            straight("%s rect. %s main" % (size, side), (front, -half, 0), (front, half, 0))
        straight("Goal %s crossbar" % side, (goal_line, -GOAL, -GOAL_HEIGHT), (goal_line, GOAL, -GOAL_HEIGHT))
        # Left and right as seen from the pitch.
        for end, y in (("left", -sign * GOAL), ("right", sign * GOAL)):
            straight("Goal %s post %s" % (side, end), (goal_line, y, 0), (goal_line, y, -GOAL_HEIGHT))
        mark = goal_line - sign * 11.0
        reach = np.arccos(5.5 / RADIUS)
        middle = np.pi if sign > 0 else 0.0
        arc("Circle " + side, mark, middle - reach, middle + reach)
    return lines


def other_end(name):
    """The class of the same line after half a turn about the pitch's middle."""
    swapped = {"left": "right", "right": "left", "top": "bottom", "bottom": "top"}
    words = name.strip().split(" ")
    if words[0] == "Goal" and "post" in words:
        # A post's own left and right turn with whoever looks at it.
        return " ".join([words[0], swapped[words[1]], *words[2:]])
    return " ".join(swapped.get(word, word) for word in words)


def rotation(pan, tilt, roll):
    p, t, r = np.radians([pan, tilt, roll])
    z = lambda a: np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    x = np.array([[1, 0, 0], [0, np.cos(t), -np.sin(t)], [0, np.sin(t), np.cos(t)]])
    return (z(p) @ x @ z(r)).T


def project(camera, points):
    x = (points - camera["position_meters"]) @ rotation(
        camera["pan_degrees"], camera["tilt_degrees"], camera["roll_degrees"]).T
    ideal = x[:, :2] / np.where(np.abs(x[:, 2:]) > 1e-9, x[:, 2:], np.nan)
    r2 = (ideal**2).sum(1, keepdims=True)
    k1, k2 = camera["radial_distortion"][:2]
    pixels = ideal * (1 + k1 * r2 + k2 * r2**2) * camera["x_focal_length"] + camera["principal_point"]
    return np.where(x[:, 2:] > 1e-3, pixels, np.nan)


def crossing(inside, outside):
    """Where the way out of the picture crosses its border."""
    share = 1.0
    for axis, most in ((0, WIDTH), (1, HEIGHT)):
        step = outside[axis] - inside[axis]
        if step > 0:
            share = min(share, (most - inside[axis]) / step)
        elif step < 0:
            share = min(share, -inside[axis] / step)
    return inside + share * (outside - inside)


def shown(camera, lines):
    """What the camera shows of each class, as pieces of polylines within the picture."""
    seen = {}
    for name, points in lines.items():
        pixels = project(camera, points)
        within = ((pixels >= 0) & (pixels <= [WIDTH, HEIGHT])).all(1)
        known = np.isfinite(pixels).all(1)
        pieces = []
        for a, b in zip(range(len(points) - 1), range(1, len(points))):
            if within[a] and within[b]:
                pieces.append((pixels[a], pixels[b]))
            elif within[a] and known[b]:
                pieces.append((pixels[a], crossing(pixels[a], pixels[b])))
            elif within[b] and known[a]:
                pieces.append((crossing(pixels[b], pixels[a]), pixels[b]))
        # Where it leaves the picture and comes back, the task's polyline goes straight on.
        joins = [(one[1], other[0]) for one, other in zip(pieces, pieces[1:]) if not np.array_equal(one[1], other[0])]
        if pieces:
            seen[name] = np.array(pieces + joins)
    return seen


def distance(point, pieces):
    along, offset = pieces[:, 1] - pieces[:, 0], point - pieces[:, 0]
    squared = (along**2).sum(1)
    share = np.clip((offset * along).sum(1) / np.where(squared > 0, squared, 1), 0, 1)
    return np.linalg.norm(offset - share[:, None] * along, axis=1).min()


def jaccard(annotated, seen, threshold):
    found = sum(
        all(distance(point, seen[name]) < threshold for point in points) for name, points in annotated.items() if name in seen)
    every = len(set(annotated) | set(seen))
    return found / every if every else 0.0


def score(annotated, seen, thresholds):
    turned = {other_end(name): points for name, points in annotated.items()}
    return [max(jaccard(names, seen, threshold) for names in (annotated, turned)) for threshold in thresholds]


def documents():
    """A document and the same with cameras that are a little off."""
    made = []
    for error in (0.0, 1.0):
        random = np.random.default_rng(20230512)
        frames = []
        for index in range(FRAMES):
            pan, tilt, f = random.uniform(-42, 42), random.uniform(-15, -8), random.uniform(1400, 4200)
            off = error * random.normal(size=3) * [0.15, 0.1, 0.006 * f] * random.uniform(0, 2)
            frames.append({
                "image": "%04d.jpg" % index, "camera": "main", "image_size_px": [1920, 1080], "status": "reference",
                "clicks": [], "ptz": {"pan_deg": pan + off[0], "tilt_deg": tilt + off[1], "focal_px": f + off[2]},
            })
        camera = {
            "id": "main", "image_size_px": [1920, 1080], "principal_point_px": [960.0, 540.0], "position_m": [1.5, -62.0, 17.0],
            "base_from_world": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
            # A negative one folds points far outside back into the picture, which the task's script takes for seen.
            "distortion": {"k1": {"at_focal_px": 2000.0, "value": 0.04, "per_1000_px": 0.0}},
        }
        made.append({"format": "touchline", "version": 1, "field": {"template": "soccer", "params": {}}, "cameras": [camera],
                     "frames": frames})
    return made


def compared(program, step_m):
    """How many of the scores are equal, of how many, and how far the means are apart; the script's own step is 0.9 m."""
    thresholds = {"jac_5": 5.0, "jac_10": 10.0, "jac_20": 20.0}
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name)
        for name, document in zip(("truth.json", "estimate.json"), documents()):
            with open(at(name), "w", encoding="utf-8") as file:
                json.dump(document, file)

        def run(*words):
            ran = subprocess.run([program, *words], capture_output=True, text=True, check=False)
            assert ran.returncode == 0, ran.stderr

        size = ["--size", "%dx%d" % (WIDTH, HEIGHT)]
        run("export", at("estimate.json"), "--format", "soccernet", "-o", at("cameras"), *size)
        run("export", at("truth.json"), "--format", "soccernet-lines", "--projected", "-o", at("lines"))
        # The same points on both sides.
        run("import", at("lines"), "--format", "soccernet-lines", "--size", "1920x1080", "-o", at("clicked.json"))
        run("evaluate", at("clicked.json"), at("estimate.json"), "-o", at("evaluation.json"))
        with open(at("evaluation.json"), encoding="utf-8") as file:
            ours = {os.path.basename(frame["frame"]): frame for frame in json.load(file)["frames"]}
        lines, same, sums = pitch(step_m), 0, np.zeros((2, len(thresholds)))
        for index in range(FRAMES):
            with open(at("cameras/camera_%04d.json" % index), encoding="utf-8") as file:
                seen = shown(json.load(file), lines)
            with open(at("lines/%04d.json" % index), encoding="utf-8") as file:
                annotated = {
                    name.strip(): [np.array([point["x"] * WIDTH, point["y"] * HEIGHT]) for point in points]
                    for name, points in json.load(file).items()}
            theirs = score(annotated, seen, thresholds.values())
            of_frame = [ours["%04d.jpg" % index][key] for key in thresholds]
            same += sum(abs(a - b) < 1e-9 for a, b in zip(theirs, of_frame))
            sums += [theirs, of_frame]
        return same, FRAMES * len(thresholds), np.abs(sums[0] - sums[1]).max() / FRAMES
