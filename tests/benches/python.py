"""Times of the Python module: project against NumPy written by hand, and a document of 300,000 frames.

usage: python.py [FRAMES]

The module must be built optimised: PROFILE=release .ci/python. Figures: python.md.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
import touchline

POINTS = 1_000_000
ROUNDS = 7


def by_hand(camera, points):
    """The same as `touchline.project`, as it is usually written."""
    rotation, centre, pinhole = camera.R, camera.C, camera.K
    k1, k2 = camera.dist[:2]
    in_camera = (points - centre) @ rotation.T
    ideal = in_camera[:, :2] / in_camera[:, 2:]
    squared = (ideal**2).sum(axis=1, keepdims=True)
    pixels = ideal * (1 + squared * (k1 + squared * k2)) * pinhole[0, 0] + pinhole[:2, 2]
    pixels[in_camera[:, 2] <= 0] = np.nan
    return pixels


def fastest(work):
    """The shortest of some rounds, s."""
    times = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        work()
        times.append(time.perf_counter() - begun)
    return min(times)


def measure_projection():
    base = touchline.Base((0.0, -60.0, 18.0), (1920, 1080), k1=0.05, k2_per_k1_squared=2.0)
    camera = base.camera(10.0, -12.0, 2500.0)
    points = np.random.default_rng(1).uniform((-60, -40, 0), (60, 40, 3), (POINTS, 3))
    np.testing.assert_allclose(touchline.project(camera, points), by_hand(camera, points), atol=1e-6, equal_nan=True)
    hand, module = fastest(lambda: by_hand(camera, points)), fastest(lambda: touchline.project(camera, points))
    print(f"project, {POINTS:,} points: {1000 * module:.1f} ms; by hand {1000 * hand:.1f} ms; {module / hand:.2f} of it")
    few = points[:100]
    hand, module = fastest(lambda: by_hand(camera, few)), fastest(lambda: touchline.project(camera, few))
    print(f"project, 100 points: {1e6 * module:.1f} µs; by hand {1e6 * hand:.1f} µs")


def write_document(path, count):
    """A video whose every 200th frame is clicked and whose frames are all solved."""
    camera = {
        "id": "main", "image_size_px": [1920, 1080], "principal_point_px": [960.0, 540.0], "position_m": [0.0, -60.0, 18.0],
        "base_from_world": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
    }
    head = {"format": "touchline", "version": 1, "field": {"template": "soccer"}, "cameras": [camera]}
    clicks = [{"landmark": "centre_mark", "image_px": [800.25, 512.5]}, {"line": "halfway_line", "image_px": [812.125, 400.0]}]
    with open(path, "w", encoding="utf-8") as file:
        file.write(json.dumps(head)[:-1] + ', "frames": [\n')
        for index in range(count):
            swing = np.sin(index / 500)
            frame = {
                "camera": "main", "image_size_px": [1920, 1080], "status": "suggested",
                "video": {"path": "match.mp4", "frame_index": index, "pts_s": index / 50},
                "clicks": clicks if index % 200 == 0 else [],
                "ptz": {"pan_deg": 30.123456 * swing, "tilt_deg": -11.987654 + swing, "focal_px": 2400.5 + 300 * swing},
                "solution": {
                    "covariance": [[2.5e-4, 1e-6, 1e-3], [1e-6, 2.5e-4, 2e-3], [1e-3, 2e-3, 12.5]],
                    "rms_px": 0.7123, "worst_corner_sigma_px": 1.9, "source": "tracking", "confidence": 0.987, "warnings": [],
                },
            }
            file.write(("" if index == 0 else ",\n") + json.dumps(frame))
        file.write("\n]}\n")


def measure_document(path):
    begun, processor = time.perf_counter(), time.process_time()
    document = touchline.load(path)
    loaded, processor = time.perf_counter() - begun, time.process_time() - processor
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    frames = document.frames
    columns = {name: fastest(lambda name=name: getattr(frames, name)) for name in ("R", "ptz", "sigma", "status")}
    print(f"load of {len(document):,} frames, {os.path.getsize(path) / 1e6:.0f} MB: {loaded:.2f} s ({processor:.2f} s of processor time), {peak:.2f} GB at most")
    print("columns:", ", ".join(f"{name} {1000 * spent:.0f} ms" for name, spent in columns.items()))
    table = time.perf_counter()
    try:
        document.to_dataframe()
        print(f"to_dataframe: {time.perf_counter() - table:.2f} s")
    except ImportError:
        print("to_dataframe: pandas is not installed")


def main(count=300_000):
    measure_projection()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "match.json")
        write_document(path, count)
        # A process of its own: the most memory is that of loading alone.
        subprocess.run([sys.executable, os.path.abspath(__file__), "--load", path], check=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--load"]:
        measure_document(sys.argv[2])
    else:
        main(*map(int, sys.argv[1:]))
