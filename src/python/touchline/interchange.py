"""What other Python packages expect: pitch coordinates, keypoints, data frames.

Pitch coordinates. touchline's world is in metres with the origin at the field's centre, x to the right
and y away from the main camera (up on a map), z up. Others put origin, direction and size elsewhere:

| package | system | here |
|---|---|---|
| mplsoccer | `Pitch(pitch_type="skillcorner", pitch_length=L, pitch_width=W)`: centre, y up, m | the world itself |
| mplsoccer | `"uefa"`: bottom left, y up, 105 × 68 | `to_pitch(p, field, "bottom_left", (105, 68))` |
| mplsoccer | `"custom"`: bottom left, y up, m | `to_pitch(p, field, "bottom_left")` |
| mplsoccer | `"statsbomb"`: top left, y down, 120 × 80 | `to_pitch(p, field, "top_left", (120, 80))` |
| kloppy | `KloppyCoordinateSystem`: top left, y down, 0 to 1 | `to_pitch(p, field, "top_left", (1, 1))` |
| kloppy | `TracabCoordinateSystem`: centre, y up, cm | `100 * p` |
| supervision | `sports.configs.soccer`: top left, y down, 12000 × 7000 cm | `to_pitch(p, field, "top_left", (12000, 7000))` |

Scaling to another size moves points evenly; the marks of the penalty areas then do not lie where a
system of fixed size draws them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ._touchline import Camera, Document, Field, project

if TYPE_CHECKING:
    import numpy.typing as npt

    Numbers = npt.NDArray[np.float64]

# Where a system's origin is, in shares of the field, and the sign of its y: 1 away from the main camera.
_ORIGINS = {"centre": (0.0, 1.0), "bottom_left": (0.5, 1.0), "top_left": (0.5, -1.0)}


def _system(
    field: Field, origin: str, size: tuple[float, float] | None
) -> tuple[float, tuple[float, float], tuple[float, float]]:
    """A system's shift in shares of the field, the signs of its axes, and its length and width."""
    if origin not in _ORIGINS:
        raise ValueError(f"origin: {origin!r} is none of {', '.join(_ORIGINS)}")
    shift, up = _ORIGINS[origin]
    return shift, (1.0, up), (field.length_m, field.width_m) if size is None else size


def to_pitch(
    points_m: npt.ArrayLike,
    field: Field,
    origin: str = "centre",
    size: tuple[float, float] | None = None,
) -> Numbers:
    """Points of the world in another system of pitch coordinates.

    `points_m`: (N, 2) or (N, 3), m. `origin`: "centre", "bottom_left" or "top_left" (y then points
    towards the main camera). `size`: length and width in the system's unit, by default the field's in
    metres. Returns (N, 2).

    >>> import touchline
    >>> pitch = touchline.field("soccer")
    >>> to_pitch([[0.0, 0.0], [52.5, 34.0]], pitch, "top_left", (120, 80)).tolist()
    [[60.0, 40.0], [120.0, 0.0]]
    """
    shift, signs, sides = _system(field, origin, size)
    points = np.asarray(points_m, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise ValueError(f"points_m: shape (N, 2) or (N, 3) is needed, not {points.shape}")
    scaled = points[:, :2] / (field.length_m, field.width_m) * signs + shift
    return np.asarray(scaled * sides, dtype=np.float64)


def from_pitch(
    points: npt.ArrayLike,
    field: Field,
    origin: str = "centre",
    size: tuple[float, float] | None = None,
) -> Numbers:
    """The inverse of `to_pitch`: (N, 2), m.

    >>> import touchline
    >>> from_pitch([[60.0, 40.0]], touchline.field("soccer"), "top_left", (120, 80)).tolist()
    [[0.0, 0.0]]
    """
    shift, signs, sides = _system(field, origin, size)
    shares = np.asarray(points, dtype=np.float64)[:, :2] / sides - shift
    world = shares * signs * (field.length_m, field.width_m)
    # Adding 0 makes −0 a 0.
    return np.asarray(world + 0.0, dtype=np.float64)


class Keypoints(NamedTuple):
    """The landmarks of a field in one picture, as `supervision.KeyPoints(xy=…, confidence=…)` takes them.

    `names`: of the L landmarks, in the field's order. `xy`: (1, L, 2), float32, px; 0 where a landmark
    is not in the picture. `visible`: (1, L), float32: 1 where it is, else 0.
    """

    names: list[str]
    xy: npt.NDArray[np.float32]
    visible: npt.NDArray[np.float32]


def keypoints(camera: Camera, field: Field) -> Keypoints:
    """The landmarks of a field as keypoints of one picture.

    >>> import touchline
    >>> base = touchline.Base((0.0, -62.0, 17.0), image_size_px=(1920, 1080))
    >>> found = keypoints(base.camera(0, -12, 1800), touchline.field("soccer"))
    >>> found.xy.shape, int(found.visible[0, found.names.index("centre_mark")])
    ((1, 47, 2), 1)
    """
    landmarks = field.landmarks
    pixels = project(camera, np.array(list(landmarks.values())))
    width, height = camera.image_size_px
    with np.errstate(invalid="ignore"):
        inside = np.logical_and(pixels >= 0, pixels <= (width, height))
    visible: npt.NDArray[np.bool_] = np.all(inside, axis=1)
    xy = np.where(visible[:, None], pixels, 0.0)
    return Keypoints(list(landmarks), xy[None].astype(np.float32), visible[None].astype(np.float32))


def to_dataframe(document: Document) -> Any:
    """The frames of a document as a pandas `DataFrame`, one row each.

    Columns: `id`, `image`, `video`, `frame_index`, `pts_s`, `camera`, `status`, `clip`, `pan_deg`,
    `tilt_deg`, `focal_px`, `k1`, `k2`, `x_m`, `y_m`, `z_m` (where the camera stands), `sigma_pan_deg`,
    `sigma_tilt_deg`, `sigma_focal_px`, `rms_px`, `confidence`, `grade`, `ground_sigma_m`,
    `visible_area_m`, `clicks` (how many). NaN where a frame is unsolved.
    """
    import pandas  # type: ignore[import-untyped, unused-ignore]

    frames = document.frames
    pictures = frames.pictures
    ptz, sigma, centre, dist = frames.ptz, frames.sigma, frames.C, frames.dist
    columns: dict[str, Any] = {"id": frames.id, **pictures, "camera": frames.camera, "status": frames.status}
    for index, name in enumerate(("pan_deg", "tilt_deg", "focal_px")):
        columns[name] = ptz[:, index]
    columns.update(k1=dist[:, 0], k2=dist[:, 1], x_m=centre[:, 0], y_m=centre[:, 1], z_m=centre[:, 2])
    for index, name in enumerate(("sigma_pan_deg", "sigma_tilt_deg", "sigma_focal_px")):
        columns[name] = sigma[:, index]
    columns.update(rms_px=frames.rms_px, confidence=frames.confidence)
    ground = frames.ground
    columns.update(grade=ground["grade"], ground_sigma_m=ground["sigma_m"], visible_area_m=ground["visible_area_m"])
    columns["clicks"] = np.bincount(frames.clicks["frame"], minlength=len(frames))
    return pandas.DataFrame(columns)
