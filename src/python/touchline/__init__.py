"""Cameras of pan-tilt-zoom sports broadcasts: pan, tilt and focal length from two clicks, or from none.

A camera of a stadium has a fixed *base* (position, base rotation, principal point, lens). Two points of
the field with their pixels then give a frame's pan, tilt and focal length:

>>> import touchline
>>> base = touchline.Base((0.0, -62.0, 17.0), image_size_px=(1920, 1080))
>>> marks = touchline.field("soccer", length_m=105.0, width_m=68.0).landmarks
>>> camera, = touchline.two_point(base, [(479.1, 672.1), (1477.7, 439.5)],
...                               [marks["centre_mark"], marks["corner_far_right"]])
>>> print(f"pan {camera.pan_deg:.1f}, tilt {camera.tilt_deg:.1f}, {camera.focal_px:.0f} px")
pan 14.0, tilt -12.0, 2000 px

What a camera shows where, as NumPy arrays; pixels without a point of the ground are NaN:

>>> touchline.project(camera, [[0, 0, 0], [11, 0, 0]]).round(1).tolist()
[[479.1, 672.1], [826.9, 649.8]]
>>> float(touchline.unproject(camera, [826.9, 649.8])[0].round(1))
11.0
>>> touchline.homography(camera).shape
(3, 3)

A document of the program is read by `load`; its frames are columns:

>>> document = touchline.load("projects/demo")
>>> frames = document.frames
>>> frames.R.shape, frames.K.shape, frames.dist.shape, frames.sigma.shape
((27, 3, 3), (27, 3, 3), (27, 5), (27, 3))
>>> str(frames.status[0])
'reference'

Conventions: world in metres, origin at the field's centre, x to the right as the main camera sees it, y
away from it, z up. Pan is positive to the right, tilt positive up, degrees. Pixels: (0, 0) is the
top-left *corner* of the picture; OpenCV's pixels are 0.5 less.
"""

from . import interchange
from ._touchline import (
    Answer,
    Base,
    Camera,
    Document,
    Error,
    Field,
    Forest,
    Frames,
    NoCamera,
    Report,
    Solution,
    __version__,
    calibrate,
    estimate_base,
    field,
    field_names,
    homography,
    iou,
    jac,
    load,
    project,
    snap,
    solve,
    solve_frame,
    track,
    two_point,
    unproject,
    visible_lines,
)

__all__ = [
    "Answer",
    "Base",
    "Camera",
    "Document",
    "Error",
    "Field",
    "Forest",
    "Frames",
    "NoCamera",
    "Report",
    "Solution",
    "__version__",
    "calibrate",
    "estimate_base",
    "field",
    "field_names",
    "homography",
    "interchange",
    "iou",
    "jac",
    "load",
    "project",
    "snap",
    "solve",
    "solve_frame",
    "track",
    "two_point",
    "unproject",
    "visible_lines",
]
