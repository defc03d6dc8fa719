"""Exports of one awkward document, read by each consumer's own reader and projected.

usage: readers.py TOUCHLINE [FORMAT...]

Without formats all of them, what is imported again, and SoccerNet's measure; `imports` and `jac` are these two by name.

The document and where its cameras show the landmarks are made here, from the formulas of the conventions alone. Twelve cameras:
bent, off-centre, on a leaning base, on the far side, on a field of 100 x 64 m, at 29.97 frames a second.
"""

import glob
import json
import os
import subprocess
import sys
import tempfile

import cv2
import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "assets", "python"))
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import soccernet_score  # noqa: E402
import touchline_dataset  # noqa: E402

WIDTH, HEIGHT = 1920, 1080
LENGTH_M, WIDTH_M = 100.0, 64.0
YARD_M = 0.9144


def turn(pan, tilt):
    sp, cp, st, ct = np.sin(pan), np.cos(pan), np.sin(tilt), np.cos(tilt)
    return np.array([[1, 0, 0], [0, ct, st], [0, -st, ct]]) @ np.array([[cp, 0, -sp], [0, 1, 0], [sp, 0, cp]])


def leaning(roll, pitch, heading):
    level = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    s, c = np.sin(roll), np.cos(roll)
    return np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ turn(heading, pitch) @ level


class Truth:
    """A camera by the formulas of the conventions."""

    def __init__(self, base, position, pan, tilt, f, k1, k2, pp):
        self.R = turn(np.radians(pan), np.radians(tilt)) @ base
        self.C, self.f, self.k1, self.k2, self.pp = np.array(position), f, k1, k2, np.array(pp)

    def project(self, world, bent=True, pp=None):
        x = (np.asarray(world, float) - self.C) @ self.R.T
        ideal = x[:, :2] / x[:, 2:]
        r2 = (ideal**2).sum(1, keepdims=True)
        scale = 1 + self.k1 * r2 + self.k2 * r2**2 if bent else 1
        pixels = ideal * scale * self.f + (self.pp if pp is None else pp)
        pixels[x[:, 2] <= 0.1] = np.nan
        return pixels


def landmarks():
    half = np.array([LENGTH_M, WIDTH_M]) / 2
    points = [(0, 0, 0)]
    for side in (-1, 1):
        x = side * half[0]
        points += [(x, y, 0) for y in (-half[1], -20.16, -9.16, 9.16, 20.16, half[1])]
        points += [(x - side * 16.5, y, 0) for y in (-20.16, 20.16)] + [(x - side * 11, 0, 0)]
        points += [(x, y, 2.44) for y in (-3.66, 3.66)]
        points += [(0, side * half[1], 0), (0, side * 9.15, 0)]
    return np.array(points, float)


def document():
    """The document and the truth of each frame."""
    cameras, frames, truths = [], [], []
    sides = [("main", (-7.25, -58.5, 16.125), 0.0, 1.0), ("far", (11.0, 61.25, 14.5), np.pi, -0.8)]
    for name, position, heading, roll in sides:
        base = leaning(np.radians(roll), np.radians(-0.6), heading)
        pp = (951.5, 548.25)
        cameras.append({
            "id": name, "image_size_px": [WIDTH, HEIGHT], "principal_point_px": pp, "position_m": position,
            "base_from_world": base.tolist(),
            "distortion": {"k1": {"at_focal_px": 2000.0, "value": -0.09, "per_1000_px": 0.03}, "k2_per_k1_squared": 2.0},
        })
        for step in range(6):
            pan, tilt, f = -35.0 + 14 * step, -10.0 - 0.5 * step, 1600.0 + 300 * step
            k1 = -0.09 + 0.03 * (f - 2000) / 1000
            number = 1800 + len(frames)
            frames.append({
                "image": "images/%04d.jpg" % (len(frames) + 1), "camera": name, "image_size_px": [WIDTH, HEIGHT],
                "video": {"path": "match.mp4", "frame_index": number, "pts_s": number * 1001 / 30000},
                "status": "reference", "clicks": [], "ptz": {"pan_deg": pan, "tilt_deg": tilt, "focal_px": f},
            })
            truths.append(Truth(base, position, pan, tilt, f, k1, 2 * k1 * k1, pp))
    size = {"length_m": LENGTH_M, "width_m": WIDTH_M}
    field = {"template": "soccer", "params": size, "size": "confirmed"}
    for frame, truth in zip(frames, truths):
        x, y = truth.project([[0, 0, 0]])[0]
        x2, y2 = truth.project([[0, WIDTH_M / 2, 0]])[0]
        for name, px, py in (("centre_mark", x, y), ("halfway_far", x2, y2)):
            if 0 <= px <= WIDTH and 0 <= py <= HEIGHT:
                frame["clicks"].append({"landmark": name, "image_px": [px, py]})
    return {"format": "touchline", "version": 1, "field": field, "cameras": cameras, "frames": frames}, truths


class Exports:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def make(self, file_format, name, *options, code=0):
        path = os.path.join(self.folder, name)
        command = [self.program, "export", os.path.join(self.folder, "doc.json"), "--format", file_format, "-o", path]
        ran = subprocess.run([*command, *options], capture_output=True, text=True, check=False)
        assert ran.returncode == code, ran.stderr
        return path


def worst(pairs):
    """The largest distance of pixels that the first of each pair shows in the picture."""
    largest = 0.0
    for wanted, found in pairs:
        seen = ((wanted >= 0) & (wanted <= [WIDTH, HEIGHT])).all(1)
        assert seen.any() and np.isfinite(found[seen]).all()
        largest = max(largest, np.abs(wanted - found)[seen].max())
    return largest


def sn_rotation(pan, tilt, roll):
    """SoccerNet's rotation, world to camera, as its camera class composes it."""
    p, t, r = np.radians([pan, tilt, roll])
    about_z = lambda a: np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, np.cos(t), -np.sin(t)], [0, np.sin(t), np.cos(t)]])
    return (about_z(p) @ about_x @ about_z(r)).T


def projected(points, rotation, position, matrix, distortion):
    rvec, _ = cv2.Rodrigues(rotation)
    pixels, _ = cv2.projectPoints(points.reshape(-1, 1, 3), rvec, -rotation @ position, matrix, np.array(distortion))
    return pixels.reshape(-1, 2)


def soccernet(exports, truths, world):
    folder = exports.make("soccernet", "soccernet")
    theirs = world * [1, -1, -1]
    pairs = []
    for truth, path in zip(truths, sorted(glob.glob(folder + "/*.json"))):
        camera = json.load(open(path, encoding="utf-8"))
        rotation = sn_rotation(camera["pan_degrees"], camera["tilt_degrees"], camera["roll_degrees"])
        (cx, cy), f = camera["principal_point"], camera["x_focal_length"]
        k, p, s = camera["radial_distortion"], camera["tangential_distortion"], camera["thin_prism_distortion"]
        matrix = np.array([[f, 0, cx], [0, f, cy], [0, 0, 1]])
        position = np.array(camera["position_meters"])
        pairs.append((truth.project(world), projected(theirs, rotation, position, matrix, [*k[:2], *p, k[2], *k[3:], *s])))
    return worst(pairs)


def broadtrack(exports, truths, world):
    entries = json.load(open(exports.make("broadtrack", "broadtrack.json"), encoding="utf-8"))
    pairs = []
    for truth, name in zip(truths, sorted(entries)):
        c = entries[name]["cp"]
        w, h = c["sensorResolutionWidthPixels"], c["sensorResolutionHeightPixels"]
        f = w / 2 / np.tan(np.radians(c["horizontalFieldOfViewDegrees"]) / 2)
        k = [value / (h / f) ** (2 * (i + 1)) for i, value in enumerate(c["normalizedRadialDistortionCoefficients"])]
        rotation = sn_rotation(c["panDegrees"], c["tiltDegrees"], c["rollDegrees"])
        position = np.array([c["positionXMeters"], c["positionYMeters"], c["positionZMeters"]])
        matrix = np.array([[f, 0, w / 2], [0, f, h / 2], [0, 0, 1]])
        centred = truth.project(world, pp=[WIDTH / 2, HEIGHT / 2])
        pairs.append((centred, projected(world * [1, -1, -1], rotation, position, matrix, [*k, 0, 0, 0])))
    return worst(pairs)


def opencv(exports, truths, world):
    folder = exports.make("opencv", "opencv")
    pairs = []
    for truth, path in zip(truths, sorted(glob.glob(folder + "/*.yml"))):
        storage = cv2.FileStorage(path, cv2.FILE_STORAGE_READ)
        get = lambda name: storage.getNode(name).mat()
        pixels, _ = cv2.projectPoints(
            world.reshape(-1, 1, 3), get("rvec"), get("tvec"), get("camera_matrix"), get("distortion_coefficients"))
        pairs.append((truth.project(world), pixels.reshape(-1, 2) + 0.5))
    return worst(pairs)


def fifa(exports, truths, world):
    with np.load(exports.make("fifa", "cameras.npz"), allow_pickle=False) as arrays:
        cameras = list(zip(arrays["K"], arrays["k"], arrays["R"], arrays["t"]))
    assert len(cameras) == len(truths)
    pairs = []
    for truth, (K, k, R, t) in zip(truths, cameras):
        pixels, _ = cv2.projectPoints(world.reshape(-1, 1, 3), cv2.Rodrigues(R)[0], t, K, k)
        pairs.append((truth.project(world), pixels.reshape(-1, 2) + 0.5))
    return worst(pairs)


def colmap(exports, truths, world):
    import pycolmap

    reconstruction = pycolmap.Reconstruction(exports.make("colmap", "colmap"))
    assert reconstruction.num_images() == len(truths)
    # Clicks on landmarks are points with tracks, where the truth has them.
    clicked = [click for clicks in clicks_of(exports).values() for click in clicks.items()]
    points = reconstruction.points3D.values()
    assert sum(point.track.length() for point in points) == len(clicked) > 0
    places = {"centre_mark": [0, 0, 0], "halfway_far": [0, WIDTH_M / 2, 0]}
    assert {tuple(point.xyz) for point in points} == {tuple(map(float, places[name])) for name, _ in clicked}
    assert all(point.error < 1e-6 for point in points)
    pairs = []
    for truth, image in zip(truths, sorted(reconstruction.images.values(), key=lambda image: image.name)):
        shown = [image.project_point(point) for point in world]
        pairs.append((truth.project(world), np.array([[np.nan] * 2 if point is None else point for point in shown])))
    return worst(pairs)


def chan(exports, truths, world):
    from scipy.spatial.transform import Rotation

    rows = np.loadtxt(exports.make("chan", "camera.chan"), delimiter="\t")
    pairs = []
    for truth, (_, tx, ty, tz, rx, ry, rz, view) in zip(truths, rows):
        rotation = Rotation.from_euler("zxy", [rz, rx, ry], degrees=True).as_matrix()
        x = (world[:, [0, 2, 1]] * [1, 1, -1] - [tx, ty, tz]) @ rotation
        f = HEIGHT / 2 / np.tan(np.radians(view) / 2)
        pixels = np.stack([WIDTH / 2 - f * x[:, 0] / x[:, 2], HEIGHT / 2 + f * x[:, 1] / x[:, 2]], 1)
        pairs.append((truth.project(world, bent=False, pp=[WIDTH / 2, HEIGHT / 2]), pixels))
    return worst(pairs)


def body_rotation(pan_left, tilt, roll):
    """World to camera of angles about Z, X, Y; the body's axes are right, forward, up."""
    from scipy.spatial.transform import Rotation

    world_from_body = Rotation.from_euler("ZXY", [pan_left, tilt, roll], degrees=True).as_matrix()
    return (world_from_body @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])).T


def opentrackio_schemas():
    """What a sample must hold here, and the standard's own schema where it lies beside the real frames."""
    data = os.environ.get("TOUCHLINE_DATA", os.path.join(ROOT, "..", "shared", "data"))
    path = os.path.join(data, "originals", "opentrackio-schema.json")
    if not os.path.exists(path):
        return [SAMPLE]
    with open(path, encoding="utf-8") as file:
        return [SAMPLE, json.load(file)]


def opentrackio(exports, truths, world):
    import jsonschema

    schemas = opentrackio_schemas()
    lines = open(exports.make("opentrackio", "camera.jsonl"), encoding="utf-8").read().splitlines()
    pairs, static = [], None
    for truth, line in zip(truths, lines, strict=True):
        sample = json.loads(line)
        for schema in schemas:
            jsonschema.validate(sample, schema, jsonschema.Draft202012Validator)
        static = sample.get("static", static)
        mm = static["camera"]["activeSensorPhysicalDimensions"]["width"] / static["camera"]["activeSensorResolution"]["width"]
        place, turned = sample["transforms"][0]["translation"], sample["transforms"][0]["rotation"]
        lens = sample["lens"]
        x = (world - [place["x"], place["y"], place["z"]]) @ body_rotation(turned["pan"], turned["tilt"], turned["roll"]).T
        screen = lens["pinholeFocalLength"] * x[:, :2] / x[:, 2:]
        (distortion,) = lens["distortion"]
        assert distortion["model"] == "Brown-Conrady U-D"
        l1, l2, l3, l4 = distortion["radial"]
        r2 = (screen**2).sum(1, keepdims=True)
        screen = screen * (1 + l1 * r2 + l3 * r2**2) / (1 + l2 * r2 + l4 * r2**2)
        offset = [lens["projectionOffset"]["x"], lens["projectionOffset"]["y"]]
        pairs.append((truth.project(world), (screen + offset) / mm + [WIDTH / 2, HEIGHT / 2]))
        code = sample["timing"]["timecode"]
        assert code["dropFrame"] and code["frameRate"] == {"num": 30000, "denom": 1001} and code["frames"] < 30
    return worst(pairs)


def freed(exports, truths, world):
    stream = open(exports.make("freed", "camera.freed"), "rb").read()
    packets = [stream[at:at + 29] for at in range(0, len(stream), 29)]
    signed = lambda packet, at: int.from_bytes(packet[at:at + 3], "big", signed=True)
    pairs = []
    for truth, packet in zip(truths, packets, strict=True):
        assert packet[0] == 0xD1 and (0x40 - sum(packet[:28])) % 256 == packet[28]
        pan, tilt, roll = (signed(packet, at) / 32768 for at in (2, 5, 8))
        position = np.array([signed(packet, at) / 64000 for at in (11, 14, 17)])
        f = int.from_bytes(packet[20:23], "big")
        assert abs(f - truth.f) <= 0.5
        x = (world - position) @ body_rotation(-pan, tilt, roll).T
        plain = Truth(np.eye(3), truth.C, 0, 0, f, 0, 0, [WIDTH / 2, HEIGHT / 2])
        plain.R = truth.R
        pairs.append((plain.project(world), x[:, :2] / x[:, 2:] * f + [WIDTH / 2, HEIGHT / 2]))
    return worst(pairs)


def usd(exports, truths, world):
    from pxr import Gf, Usd, UsdGeom

    stage = Usd.Stage.Open(exports.make("usda", "camera.usda", "--camera", "main"))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 0.01 and abs(stage.GetTimeCodesPerSecond() - 30000 / 1001) < 1e-9
    camera = UsdGeom.Camera(stage.GetPrimAtPath("/Match/main"))
    pairs = []
    for truth, time in zip(truths[:6], range(1800, 1806)):
        frustum = camera.GetCamera(time).frustum
        matrix = frustum.ComputeViewMatrix() * frustum.ComputeProjectionMatrix()
        points = [matrix.Transform(Gf.Vec3d(100 * x, 100 * z, -100 * y)) for x, y, z in world]
        pixels = np.array([[(p[0] + 1) / 2 * WIDTH, (1 - p[1]) / 2 * HEIGHT] for p in points])
        pairs.append((truth.project(world, bent=False), pixels))
    return worst(pairs)


def ground(world):
    return world[world[:, 2] == 0]


def wc14(exports, truths, world):
    folder = exports.make("wc14", "wc14", "--undistorted")
    on_ground = ground(world)
    template = np.stack([on_ground[:, 0] / YARD_M + 57.415, 37.185 - on_ground[:, 1] / YARD_M], 1)
    pairs = []
    for truth, path in zip(truths, sorted(glob.glob(folder + "/*.homographyMatrix"))):
        inverse = np.linalg.inv(np.loadtxt(path))
        pixels = cv2.perspectiveTransform(template.reshape(-1, 1, 2), inverse).reshape(-1, 2) + 0.5
        pairs.append((truth.project(on_ground, bent=False), pixels))
    return worst(pairs)


def tsworldcup(exports, truths, world):
    folder = exports.make("tsworldcup", "ts", "--undistorted", "--camera", "main")
    on_ground = ground(world)
    template = np.stack([on_ground[:, 0] / YARD_M + 57.415, 37.185 - on_ground[:, 1] / YARD_M, np.ones(len(on_ground))], 1)
    videos = open(folder + "/test.txt", encoding="utf-8").read().split()
    pairs = []
    for video in videos:
        for truth, path in zip(truths, sorted(glob.glob("%s/Annotations/80_95/%s/*.npy" % (folder, video)))):
            pixels = template @ np.linalg.inv(np.load(path, allow_pickle=False)).T
            pairs.append((truth.project(on_ground, bent=False), pixels[:, :2] / pixels[:, 2:] + 0.5))
    assert len(pairs) == 6
    return worst(pairs)


def csv(exports, truths, world):
    import pandas

    table = pandas.read_csv(exports.make("csv", "cameras.csv"))
    on_ground = ground(world)
    names = [(row, column) for row in "123" for column in "123"]
    assert table.timecode[0] == "00:01:00;02", "frame 1800 at 29.97 frames a second"
    pairs = []
    for truth, (_, row) in zip(truths, table.iterrows()):
        rotation = np.array([row["r%s%s" % name] for name in names]).reshape(3, 3)
        t = np.array([row["t_x_m"], row["t_y_m"], row["t_z_m"]])
        matrix = np.array([[row.focal_px, 0, row.cx_px], [0, row.focal_px, row.cy_px], [0, 0, 1]])
        pixels, _ = cv2.projectPoints(
            world.reshape(-1, 1, 3), cv2.Rodrigues(rotation)[0], t, matrix, np.array([row.k1, row.k2, 0, 0, 0]))
        pairs.append((truth.project(world), pixels.reshape(-1, 2)))
        h = np.array([row["h_pitch_from_image_%s%s" % name] for name in names]).reshape(3, 3)
        flat = truth.project(on_ground, bent=False)
        seen = ((flat >= 0) & (flat <= [WIDTH, HEIGHT])).all(1)
        back = np.column_stack([flat[seen], np.ones(seen.sum())]) @ h.T
        assert np.abs(back[:, :2] / back[:, 2:] - on_ground[seen, :2]).max() < 1e-9, "metres"
    return worst(pairs)


def clicks_of(exports):
    document = json.load(open(os.path.join(exports.folder, "doc.json"), encoding="utf-8"))
    frames = [frame for frame in document["frames"] if frame["clicks"]]
    return {os.path.basename(frame["image"]): {c["landmark"]: c["image_px"] for c in frame["clicks"]} for frame in frames}


def coco(exports, _truths, _world):
    import contextlib
    import io

    from pycocotools.coco import COCO

    path = exports.make("coco", "keypoints.json", code=1)
    with contextlib.redirect_stdout(io.StringIO()):
        data = COCO(path)
    names = data.loadCats(data.getCatIds())[0]["keypoints"]
    largest, wanted = 0.0, clicks_of(exports)
    for image in data.loadImgs(data.getImgIds()):
        (annotation,) = data.loadAnns(data.getAnnIds(imgIds=[image["id"]]))
        points = np.array(annotation["keypoints"]).reshape(-1, 3)
        found = {name: point[:2] + 0.5 for name, point in zip(names, points) if point[2] == 2}
        expected = wanted.pop(image["file_name"])
        assert found.keys() == expected.keys() and annotation["num_keypoints"] == len(found)
        largest = max([largest, *(np.abs(found[name] - expected[name]).max() for name in found)])
    assert not wanted
    return largest


def yolo(exports, _truths, _world):
    import yaml

    folder = exports.make("yolo-pose", "yolo", code=1)
    data = yaml.safe_load(open(folder + "/data.yaml", encoding="utf-8"))
    count, dims = data["kpt_shape"]
    names = data["kpt_names"][0]
    assert dims == 3 and len(names) == count == len(data["flip_idx"]) and data["names"] == {0: "pitch"}
    assert [data["flip_idx"][i] for i in data["flip_idx"]] == list(range(count)), "mirrored twice is the same"
    largest = 0.0
    for image, expected in clicks_of(exports).items():
        (line,) = open("%s/labels/train/%s.txt" % (folder, image[:-4]), encoding="utf-8").read().splitlines()
        values = np.array(line.split(), float)
        assert len(values) == 5 + 3 * count and (values >= 0).all() and (values[1:5] <= 1).all() and (values[3:5] > 0).all()
        points = values[5:].reshape(-1, 3)
        found = {name: point[:2] * [WIDTH, HEIGHT] for name, point in zip(names, points) if point[2] == 2}
        assert found.keys() == expected.keys()
        largest = max([largest, *(np.abs(found[name] - expected[name]).max() for name in found)])
    return largest


def dataset(exports, truths, world):
    data = touchline_dataset.load(exports.make("json", "dataset.json"))
    assert len(data) == len(truths) and data.unsolved == 0
    pairs = []
    for index, truth in enumerate(truths):
        pairs.append((truth.project(world), data.project(index, world)))
        rotation, t, matrix, distortion = data.opencv(index)
        pixels, _ = cv2.projectPoints(world.reshape(-1, 1, 3), cv2.Rodrigues(rotation)[0], t, matrix, distortion)
        pairs.append((truth.project(world), pixels.reshape(-1, 2) + 0.5))
    return worst(pairs)


# What a sample of OpenTrackIO 1.0.1 must hold here, from its schema's types (draft 2020-12).
NUMBER, COUNT = {"type": "number"}, {"type": "integer", "minimum": 0}
RATE = {"type": "object", "required": ["num", "denom"], "properties": {"num": COUNT, "denom": COUNT}, "additionalProperties": False}


def exactly(**properties):
    return {"type": "object", "required": list(properties), "properties": properties, "additionalProperties": False}


SAMPLE = {
    "type": "object",
    "required": ["protocol", "sampleId", "sourceId", "lens", "transforms", "timing"],
    "properties": {
        "protocol": exactly(name={"const": "OpenTrackIO"}, version={"const": [1, 0, 1]}),
        "sampleId": {"type": "string", "pattern": "^urn:uuid:[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$"},
        "sourceId": {"type": "string", "pattern": "^urn:uuid:[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$"},
        "sourceNumber": COUNT,
        "tracker": exactly(status={"type": "string"}, recording={"type": "boolean"}, notes={"type": "string", "maxLength": 1023}),
        "timing": exactly(
            mode={"enum": ["internal", "external"]}, sampleRate=RATE, sequenceNumber=COUNT,
            timecode=exactly(hours={**COUNT, "maximum": 23}, minutes={**COUNT, "maximum": 59}, seconds={**COUNT, "maximum": 59},
                             frames=COUNT, frameRate=RATE, dropFrame={"type": "boolean"})),
        "lens": exactly(
            pinholeFocalLength={"type": "number", "exclusiveMinimum": 0}, projectionOffset=exactly(x=NUMBER, y=NUMBER),
            entrancePupilOffset=NUMBER,
            distortion={"type": "array", "minItems": 1, "items": exactly(
                model={"type": "string"}, radial={"type": "array", "items": NUMBER, "minItems": 1})}),
        "transforms": {"type": "array", "minItems": 1, "items": exactly(
            id={"type": "string"}, translation=exactly(x=NUMBER, y=NUMBER, z=NUMBER),
            rotation=exactly(pan=NUMBER, tilt=NUMBER, roll=NUMBER))},
        "static": exactly(camera={"type": "object", "required": ["activeSensorResolution", "activeSensorPhysicalDimensions"]}),
    },
    "additionalProperties": False,
}


def deepsport(exports, _truths, _world):
    """Cameras that calib3d projects with, imported here; the largest distance of the court's points."""
    from calib3d import Calib, Point3D

    length, width = 28.0, 15.0
    points = np.array([(x, y, z) for x in np.linspace(-14, 14, 9) for y in np.linspace(-7.5, 7.5, 7) for z in (0, 3.05)])
    folder = os.path.join(exports.folder, "deepsport")
    os.mkdir(folder)
    wanted = []
    for index, (pan, tilt, f, k1) in enumerate([(0, -14, 1500.0, 0.0), (-18, -12, 2100.0, -0.08), (21, -17, 1800.0, 0.05)]):
        truth = Truth(leaning(0.01, -0.005, 0.02), (1.5, -21.0, 9.0), pan, tilt, f, k1, 0.0, (957.25, 541.5))
        rotation = truth.R @ np.diag([1.0, -1, -1])
        centre = np.array([truth.C[0] + length / 2, width / 2 - truth.C[1], -truth.C[2]]) * 100
        translation = -rotation @ centre
        matrix = np.array([[f, 0, truth.pp[0] - 0.5], [0, f, truth.pp[1] - 0.5], [0, 0, 1]])
        lens = np.array([k1, 0, 0, 0, 0])
        calibration = {"img_width": WIDTH, "img_height": HEIGHT, "KK": matrix.ravel().tolist(), "kc": lens.tolist(),
                       "R": rotation.ravel().tolist(), "T": translation.tolist()}
        with open("%s/camcourt1_%d.json" % (folder, index), "w", encoding="utf-8") as file:
            json.dump({"calibration": calibration}, file)
        theirs = np.stack([points[:, 0] + length / 2, width / 2 - points[:, 1], -points[:, 2]]) * 100
        calib = Calib(width=WIDTH, height=HEIGHT, T=translation.reshape(3, 1), R=rotation, K=matrix, k=lens)
        wanted.append(np.asarray(calib.project_3D_to_2D(Point3D(theirs))).T + 0.5)
    path = os.path.join(exports.folder, "deepsport.json")
    command = [exports.program, "import", folder, "--format", "deepsport", "--field", "basketball_fiba", "-o", path]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    data = touchline_dataset.load(path)
    assert len(data) == 3
    return worst([(pixels, data.project(index, points)) for index, pixels in enumerate(wanted)])


def cdf(exports, truths, _world):
    import cdf as common_data_format

    options = ["--match-id", "m1", "--start-time", "2026-03-01T18:59:30Z", "--perspective", "camera_1", "--camera", "main"]
    path = exports.make("cdf", "video.json", *options, "--fps", "25")
    common_data_format.VideoSchemaValidator().validate_schema(sample=path, mode="extreme")
    place = json.load(open(path, encoding="utf-8"))["recording"]["camera"]
    return np.abs(np.array([place["x"], place["y"], place["z"]]) - truths[0].C).max()


def plain(truth):
    """What formats without a lens and a principal point keep of a camera."""
    return lambda world: truth.project(world, bent=False, pp=[WIDTH / 2, HEIGHT / 2])


def whole(truth):
    return truth.project


def straight(truth):
    """The ground of a picture without lens distortion; what stands on it takes no part in a homography."""
    return lambda world: np.where(world[:, 2:] == 0, truth.project(world, bent=False), np.nan)


def without_point(truth):
    return lambda world: truth.project(world, pp=[WIDTH / 2, HEIGHT / 2])


def whole_zoom(truth):
    """FreeD's zoom is a whole number."""
    rounded = Truth(np.eye(3), truth.C, 0, 0, float(round(truth.f)), 0, 0, [WIDTH / 2, HEIGHT / 2])
    rounded.R = truth.R
    return rounded.project


# Formats of cameras that are read again by `touchline import`: what is exported and imported with, what the format keeps, px.
SIZE = ["--size", "%dx%d" % (WIDTH, HEIGHT)]
ZOOM = ["--zoom", "focal-px"]
BACK = [
    ("soccernet", "soccernet", [], SIZE, whole, 1e-6),
    ("pnlcalib", "soccernet", [], SIZE, whole, 1e-6),
    ("csv", "csv", [], [], whole, 1e-6),
    ("broadtrack", "broadtrack", [], [], without_point, 1e-6),
    ("colmap", "colmap", [], [], whole, 1e-6),
    ("opencv", "opencv", [], [], whole, 1e-6),
    ("fifa", "fifa", [], SIZE, whole, 1e-6),
    ("opentrackio", "opentrackio", [], [], whole, 1e-6),
    ("chan", "chan", [], SIZE, plain, 1e-6),
    ("freed", "freed", ZOOM, SIZE + ZOOM, whole_zoom, 7e-3),
    ("freed-csv", "freed-csv", ZOOM, SIZE + ZOOM, whole_zoom, 1e-6),
]
# A homography has no principal point: cameras are fitted to it with theirs in the middle, 12 px beside that of the truth.
FITTED = [
    ("wc14", "wc14", ["--undistorted"], SIZE, straight, 2.0),
    ("tsworldcup", "tsworldcup", ["--undistorted"], SIZE, straight, 2.0),
    ("homography", "homography", ["--undistorted"], SIZE, straight, 2.0),
]


def imported(exports, name, exported, options=()):
    """The document that the program makes of exported files."""
    document = os.path.join(exports.folder, "back-%s.json" % name)
    field = ["--set", "length_m=%r" % LENGTH_M, "--set", "width_m=%r" % WIDTH_M]
    command = [exports.program, "import", exported, "--format", name, "-o", document, *field, *options]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    return document


def back(exports, truths, world):
    """Each format of cameras imported again by the program, against the formulas: format, largest distance, allowed, px."""
    for name, written_as, out, into, kept, allowed in BACK + FITTED:
        exported = exports.make(written_as, "again-" + name, *out)
        data = touchline_dataset.load(imported(exports, name, exported, into))
        assert len(data) == len(truths), name
        # Formats name frames by picture, by number or not at all; all keep their order.
        order = sorted(range(len(data)), key=lambda index: data.videos[index] or (os.path.basename(data.images[index]), 0))
        yield name, worst([(kept(truth)(world), data.project(index, world)) for truth, index in zip(truths, order)]), allowed


def clicks_back(exports):
    """Each format of clicks imported again: format, largest distance of a click, allowed, px."""
    wanted = clicks_of(exports)
    for name, allowed in (("coco", 1e-9), ("yolo-pose", 1e-6), ("label-studio", 1e-9), ("labelme", 0.0)):
        document = imported(exports, name, exports.make(name, "again-" + name, code=1), SIZE)
        with open(document, encoding="utf-8") as file:
            frames = [frame for frame in json.load(file)["frames"] if frame["clicks"]]
        found = {os.path.splitext(os.path.basename(frame["image"]))[0]: frame["clicks"] for frame in frames}
        assert len(found) == len(wanted), name
        largest = 0.0
        for image, expected in wanted.items():
            clicks = {click["landmark"]: click["image_px"] for click in found[os.path.splitext(image)[0]]}
            assert clicks.keys() == expected.keys(), name
            largest = max([largest, *(np.abs(np.subtract(clicks[label], at)).max() for label, at in expected.items())])
        yield name, largest, allowed


READERS = [
    ("soccernet", soccernet, "its formulas, cv2.projectPoints", 1e-6),
    ("csv", csv, "pandas.read_csv, cv2.projectPoints", 1e-6),
    ("yolo-pose", yolo, "PyYAML, Ultralytics' rules", 1e-6),
    ("coco", coco, "pycocotools", 1e-6),
    ("wc14", wc14, "numpy.loadtxt, cv2.perspectiveTransform", 1e-6),
    ("tsworldcup", tsworldcup, "numpy.load", 1e-6),
    ("broadtrack", broadtrack, "its formulas, cv2.projectPoints", 1e-6),
    ("colmap", colmap, "pycolmap", 1e-6),
    ("opencv", opencv, "cv2.FileStorage, cv2.projectPoints", 1e-6),
    ("fifa", fifa, "numpy.load, cv2.projectPoints", 1e-6),
    ("usda", usd, "usd-core, the camera's frustum", 1e-3),
    ("opentrackio", opentrackio, "jsonschema, its formulas, scipy", 1e-6),
    ("freed", freed, "its table of bytes, scipy", 7e-3),
    ("chan", chan, "scipy, order zxy", 1e-6),
    ("deepsport", deepsport, "calib3d (imported)", 1e-6),
    ("cdf", cdf, "common-data-format-validator, mode extreme", 0.0),
    ("json", dataset, "assets/python/touchline_dataset.py", 1e-6),
]


def main():
    program, asked = sys.argv[1], sys.argv[2:]
    wants = lambda name: not asked or name in asked
    failed = []

    def said(name, reader, off, allowed):
        if not off <= allowed:
            failed.append("%s by %s" % (name, reader))
        print("%-12s %-42s %.1e px%s" % (name, reader, off, "" if off <= allowed else "  TOO FAR, allowed %g" % allowed))

    with tempfile.TemporaryDirectory() as folder:
        made, truths = document()
        with open(os.path.join(folder, "doc.json"), "w", encoding="utf-8") as file:
            json.dump(made, file)
        exports = Exports(program, folder)
        world = landmarks()
        for name, read, reader, allowed in READERS:
            if wants(name):
                said(name, reader, read(exports, truths, world), allowed)
        if wants("imports"):
            for name, off, allowed in [*back(exports, truths, world), *clicks_back(exports)]:
                said(name, "touchline import", off, allowed)
    if wants("jac"):
        # At the step of the task's own script, and at one that leaves nothing to where its points fall at the picture's border.
        for step_m, least in ((0.9, 0.98), (0.05, 0.995)):
            same, every, apart = soccernet_score.compared(program, step_m)
            print("JaC, a point every %g m: %d of %d scores are equal, the means differ by %.1e" % (step_m, same, every, apart))
            if same < least * every or apart > 2e-3:
                failed.append("JaC")
    sys.exit("failed: " + ", ".join(failed) if failed else 0)


if __name__ == "__main__":
    main()
