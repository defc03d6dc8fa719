"""Reads a touchline dataset (or project.json) with numpy alone.

    from touchline_dataset import load
    data = load("dataset")                                          # a folder, or its dataset.json
    pixels = data.project(0, [[0.0, 0.0, 0.0], [0.0, 34.0, 0.0]])   # world metres -> px of frame 0
    lines = data.overlay(0)                                         # the field's lines as frame 0 shows them, px
    train = [i for i in range(len(data)) if data.split[i] == "train"]

World: origin at the field's centre, x right along its length seen from the main camera, y away from that camera, z up, metres.
Pixels: (0, 0) is the top-left corner of the picture; libraries that count from the first pixel's centre (OpenCV, COCO) need 0.5 less.
Angles: pan positive to the right, tilt positive up; x_cam = R (X - C), camera x right, y down, z forward.
Licence: MIT, as touchline.
"""

import csv
import json
import os

import numpy as np


class Dataset:
    """Solved frames as arrays; row i of each array is frame i.

    images      list of paths (None where a frame comes from a video only), as the file has them
    videos      list of (path, frame index) or None
    cameras     list of camera names
    status      list: new, draft, suggested, reference, rejected
    source      list: clicks, forest, tracking, markings, import, ... or None
    size        (n, 2) width and height, px
    pan, tilt   (n,) degrees
    f           (n,) focal length, px (fx)
    k1, k2      (n,) radial distortion on normalised coordinates
    R           (n, 3, 3) world to camera
    C           (n, 3) centre of projection, m
    K           (n, 3, 3) calibration, corner convention
    H           (n, 3, 3) undistorted pixel to pitch (m), scaled to H[2, 2] = 1
    sigma       (n, 3) 1-sigma of pan, tilt (degrees) and focal length (px); NaN where not known
    confidence  (n,) NaN where not known
    grade       list: speed, map, none: what places on the ground are good for; None where not stated
    ground_sigma (n,) 1-sigma of a place on the ground in the picture's middle third, m; NaN where not known
    visible_area list of (m, 2) corners of the part of the field in the picture, m
    clicks      list of lists of (name, x, y, is_line, is_check)
    split       list: train, validation, test; empty where the dataset is not divided
    label       list: where each camera comes from: clicked, snapped, suggested_and_accepted, interpolated, ... (frames.csv)
    """

    def __init__(self, document, folder=".", rows=(), fields=None):
        if document.get("format") != "touchline":
            raise ValueError("this is no touchline document")
        if document.get("version") != 1:
            raise ValueError("version %r is newer than this reader" % document.get("version"))
        self.document, self.folder = document, folder
        self._fields = {camera: field for field in (fields or {}).get("fields", []) for camera in field["cameras"]}
        cameras = {camera["id"]: camera for camera in document["cameras"]}
        frames = [f for f in document["frames"] if f.get("ptz") and cameras[f["camera"]].get("position_m")]
        self.unsolved = len(document["frames"]) - len(frames)
        self.images = [f.get("image") for f in frames]
        videos = [f.get("video") for f in frames]
        self.videos = [(v["path"], v["frame_index"]) if v else None for v in videos]
        self.cameras = [f["camera"] for f in frames]
        self.status = [f["status"] for f in frames]
        solutions = [f.get("solution") or {} for f in frames]
        self.source = [s.get("source") for s in solutions]
        self.size = np.array([f["image_size_px"] for f in frames], int).reshape(-1, 2)
        self.pan = np.array([f["ptz"]["pan_deg"] for f in frames], float)
        self.tilt = np.array([f["ptz"]["tilt_deg"] for f in frames], float)
        self.f = np.array([f["ptz"]["focal_px"] for f in frames], float)
        lenses = [_lens(cameras[f["camera"]], f) for f in frames]
        self.k1, self.k2 = np.array(lenses, float).reshape(-1, 2).T
        bases = [np.array(cameras[f["camera"]]["base_from_world"], float) for f in frames]
        turned = [_turn(p, t) @ _rotation(b) for p, t, b in zip(self.pan, self.tilt, bases)]
        self.R = np.array(turned, float).reshape(-1, 3, 3)
        self.C = np.array([cameras[f["camera"]]["position_m"] for f in frames], float).reshape(-1, 3)
        stated = [f.get("lens") or cameras[f["camera"]] for f in frames]
        pinholes = [(f, f * s.get("pixel_aspect", 1.0), *s["principal_point_px"]) for f, s in zip(self.f, stated)]
        self.K = np.array([[[fx, 0, x], [0, fy, y], [0, 0, 1]] for fx, fy, x, y in pinholes], float).reshape(-1, 3, 3)
        ground = np.concatenate([self.R[:, :, :2], self.t[:, :, None]], axis=2)
        inverse = np.linalg.inv(self.K @ ground)
        self.H = inverse / inverse[:, 2:, 2:]
        covariances = [np.array(s["covariance"], float) if s.get("covariance") else np.full((3, 3), np.nan) for s in solutions]
        self.sigma = np.sqrt(np.array([np.diag(c) for c in covariances], float).reshape(-1, 3))
        self.confidence = np.array([s.get("confidence", np.nan) for s in solutions], float)
        on_ground = [s.get("ground") or {} for s in solutions]
        self.grade = [g.get("grade") for g in on_ground]
        self.ground_sigma = np.array([g.get("sigma_m", np.nan) for g in on_ground], float)
        self.visible_area = [np.array(g.get("visible_area_m", []), float).reshape(-1, 2) for g in on_ground]
        known = {_cell(row["id"]): row for row in rows}
        self.split = [known.get(f.get("id"), {}).get("split", "") for f in frames]
        self.label = [known.get(f.get("id"), {}).get("label", "") for f in frames]
        self.clicks = [[_click(c) for c in f.get("clicks", []) if "landmark" in c or "line" in c] for f in frames]

    def __len__(self):
        return len(self.f)

    @property
    def t(self):
        """(n, 3) translation of x_cam = R X + t, m."""
        return -np.einsum("nij,nj->ni", self.R, self.C)

    def project(self, index, world):
        """Pixels (m, 2), corner convention, of world points (m, 3); NaN for what the camera cannot see."""
        camera = (np.asarray(world, float).reshape(-1, 3) - self.C[index]) @ self.R[index].T
        with np.errstate(divide="ignore", invalid="ignore"):
            ideal = camera[:, :2] / camera[:, 2:]
        r2 = (ideal**2).sum(axis=1)
        k1, k2 = self.k1[index], self.k2[index]
        bent = ideal * (1 + r2 * (k1 + r2 * k2))[:, None]
        pixels = bent * self.K[index].diagonal()[:2] + self.K[index, :2, 2]
        folded = r2 >= _fold(k1, k2)
        pixels[(camera[:, 2] <= 1e-6 * np.linalg.norm(camera, axis=1)) | folded] = np.nan
        return pixels

    def picture(self, index):
        """The path of a frame's picture."""
        return os.path.join(self.folder, self.images[index])

    def field(self, index):
        """The field that a frame shows: template, length_m, width_m, landmarks and lines by name, m."""
        return self._fields[self.cameras[index]]

    def overlay(self, index):
        """Pixels (m, 2) of the field's lines by name; NaN for what lies more than half a picture outside."""
        lines = {}
        for name, points in self.field(index)["lines"].items():
            pixels = self.project(index, points)
            with np.errstate(invalid="ignore"):
                near = ((pixels > -0.5 * self.size[index]) & (pixels < 1.5 * self.size[index])).all(axis=1)
            if near.any():
                lines[name] = np.where(near[:, None], pixels, np.nan)
        return lines

    def opencv(self, index):
        """(rotation matrix, t, camera matrix, distortion) of a frame in OpenCV's pixels, for cv2.projectPoints."""
        matrix = self.K[index].copy()
        matrix[:2, 2] -= 0.5
        return self.R[index], self.t[index], matrix, np.array([self.k1[index], self.k2[index], 0, 0, 0])


def load(path):
    """The dataset of a file, or of the folder of a project or exported dataset."""
    if os.path.isdir(path):
        names = [os.path.join(path, name) for name in ("dataset.json", "project.json")]
        path = next((name for name in names if os.path.exists(name)), names[0])
    folder = os.path.dirname(path) or "."
    # The pictures without distortion have what they share with the others one folder up.
    beside = [[os.path.join(folder, up, name) for name in ("frames.csv", "fields.json")] for up in ("", "..")]
    tables = next((names for names in beside if all(map(os.path.exists, names))), None)
    rows, fields = [], None
    if tables is not None:
        with open(tables[0], encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        with open(tables[1], encoding="utf-8") as file:
            fields = json.load(file)
    with open(path, encoding="utf-8") as file:
        return Dataset(json.load(file), folder, rows, fields)


def _cell(text):
    """The text of a cell, without the apostrophe that keeps a spreadsheet from calculating it."""
    guarded = text.startswith("'") and text.lstrip("'")[:1] in ("=", "+", "-", "@", "\t", "\r")
    return text[1:] if guarded else text


def _lens(camera, frame):
    """k1 and k2 of a frame: of the lens that it states, else of the camera's curve, where it has one, else its own k1."""
    ptz, lens = frame["ptz"], frame.get("lens")
    if lens:
        return lens.get("k1") or 0.0, lens.get("k2") or 0.0
    distortion = camera.get("distortion") or {}
    curve = distortion.get("k1")
    if curve is None:
        return ptz.get("k1") or 0.0, 0.0
    slope = curve.get("per_1000_px", 0.0) / 1000.0
    k1 = curve["value"] + slope * (ptz["focal_px"] - curve.get("at_focal_px", 0.0))
    return k1, distortion.get("k2_per_k1_squared", 0.0) * k1 * k1


def _fold(k1, k2):
    """The squared ideal radius beyond which the lens model folds and nothing has an image."""
    if k2 == 0:
        return -1 / (3 * k1) if k1 < 0 else np.inf
    discriminant = 9 * k1 * k1 - 20 * k2
    if discriminant < 0:
        return np.inf
    divisor = np.sqrt(discriminant) - 3 * k1
    return 2 / divisor if divisor > 0 else np.inf


def _turn(pan_deg, tilt_deg):
    """Q_tilt Q_pan."""
    (sp, cp), (st, ct) = [(np.sin(a), np.cos(a)) for a in np.radians([pan_deg, tilt_deg])]
    return np.array([[1, 0, 0], [0, ct, st], [0, -st, ct]]) @ np.array([[cp, 0, -sp], [0, 1, 0], [sp, 0, cp]])


def _rotation(matrix):
    """The rotation nearest to a matrix whose digits were rounded."""
    u, _, vt = np.linalg.svd(matrix)
    return u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt


def _click(click):
    is_line = "line" in click
    x, y = click["image_px"]
    return click["line" if is_line else "landmark"], x, y, is_line, bool(click.get("check"))
