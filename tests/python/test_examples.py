"""The scripts of tests/examples/python, run as a user would on small input."""

import os
import subprocess
import sys
import tempfile
import unittest

import cv2
import numpy as np
import support
import touchline

EXAMPLES = os.path.join(support.ROOT, "tests", "examples", "python")
TRUTH = os.path.join(support.DEMO, "truth.json")


def run(script, *arguments):
    ran = subprocess.run(
        [sys.executable, os.path.join(EXAMPLES, script), *arguments], capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


class Examples(unittest.TestCase):
    def test_heat_map(self):
        truth = touchline.load(TRUTH)
        rows = []
        for index in range(len(truth)):
            x, y = touchline.project(truth.camera(index), [30.0, 10.0, 0.0])
            rows += [(index, x - 10, y - 60, 20, 60)] if 0 < x < 1280 and 0 < y < 720 else []
        self.assertGreater(len(rows), 3)
        with tempfile.TemporaryDirectory() as folder:
            boxes, out = os.path.join(folder, "boxes.csv"), os.path.join(folder, "out.png")
            np.savetxt(boxes, rows, delimiter=",", header="frame,x,y,width,height")
            run("heat_map.py", TRUTH, boxes, out)
            heat = cv2.imread(out).sum(axis=2)
        field = truth.field
        self.assertEqual(heat.shape, (int(2 * field.width_m), int(2 * field.length_m)))
        # All stood at (30, 10): right of the centre and beyond it.
        row, column = np.unravel_index(heat.argmax(), heat.shape)
        self.assertAlmostEqual(column / 2 - field.length_m / 2, 30.0, delta=1.0)
        self.assertAlmostEqual(field.width_m / 2 - row / 2, 10.0, delta=1.0)

    @unittest.skipIf(support.NO_PROGRAM, support.NO_PROGRAM)
    def test_soccernet_jac(self):
        with tempfile.TemporaryDirectory() as folder:
            # The truth's own lines, as SoccerNet annotates them.
            lines = os.path.join(folder, "lines")
            support.run("export", TRUTH, "--format", "soccernet-lines", "--projected", "-o", lines)
            for name in sorted(os.listdir(lines))[3:]:
                os.remove(os.path.join(lines, name))
            said = run("soccernet_jac.py", lines, TRUTH)
        self.assertRegex(said, r"^JaC@5 (0\.9\d\d|1\.000) of 3 pictures$")

    def test_homographies(self):
        said = run("homographies.py", support.DEMO)
        self.assertRegex(said, r"^9 pictures of shape \(3, 180, 320\)\n")
        sys.path.insert(0, EXAMPLES)
        try:
            import homographies
        finally:
            sys.path.remove(EXAMPLES)
        self.assertNotIn("torch", sys.modules)
        data = homographies.Homographies(support.DEMO, stride=2)
        document = touchline.load(support.DEMO)
        picture, homography = data[0]
        self.assertEqual((picture.dtype, homography.dtype), (np.float32, np.float32))
        index = int(data.rows[0])
        np.testing.assert_array_equal(picture[:, 5, 7] * 255, document.image(index)[10, 14])
        whole = touchline.homography(document.camera(index)) @ (20.0, 5.0, 1.0)
        reduced = homography.astype(float) @ (20.0, 5.0, 1.0)
        # A kept pixel's centre: 2 c + 0.5 before, c + 0.5 now.
        np.testing.assert_allclose(2 * reduced[:2] / reduced[2] - 0.5, whole[:2] / whole[2], atol=1e-2)


if __name__ == "__main__":
    unittest.main()
