"""What cameras show where, against OpenCV and against the formulas of the conventions."""

import unittest

import cv2
import numpy as np
import touchline


def cameras(count=50):
    """Cameras of all kinds: leaning, off-centre, with and without a lens."""
    random = np.random.default_rng(1)
    for _ in range(count):
        position = random.uniform((-20, -80, 5), (20, -40, 30))
        lean = cv2.Rodrigues(random.normal(0, 0.02, 3))[0]
        level = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
        k1 = random.choice([0.0, random.uniform(-0.3, 0.3)])
        base = touchline.Base(
            position, (1920, 1080), lean @ level, random.uniform((900, 500), (1000, 580)), k1=k1, k2_per_k1_squared=2.0,
            pixel_aspect=random.choice([1.0, random.uniform(0.6, 1.8)]),
        )
        yield base.camera(random.uniform(-40, 40), random.uniform(-25, -5), random.uniform(1000, 6000))


class Cameras(unittest.TestCase):
    def test_project_agrees_with_opencv(self):
        random = np.random.default_rng(2)
        points = np.column_stack([random.uniform(-60, 60, (500, 2)), random.uniform(0, 3, 500)])
        compared, worst = 0, 0.0
        for camera in cameras():
            pixels = touchline.project(camera, points)
            # OpenCV has no test for what lies behind: those shown are compared.
            shown = np.isfinite(pixels).all(axis=1)
            rotation = cv2.Rodrigues(camera.R)[0]
            expected, _ = cv2.projectPoints(points, rotation, -camera.R @ camera.C, camera.K, camera.dist)
            near = shown & (np.abs(pixels) < 1e5).all(axis=1)
            compared += int(near.sum())
            worst = max(worst, np.abs(pixels - expected[:, 0])[near].max())
        self.assertGreater(compared, 10_000)
        # A rotation vector and back costs OpenCV digits: 1e-16 of it are 1e-9 px far outside the picture.
        self.assertLess(worst, 1e-8)

    def test_project_agrees_with_opencv_in_the_picture(self):
        random = np.random.default_rng(3)
        points = np.column_stack([random.uniform(-60, 60, (2000, 2)), np.zeros(2000)])
        worst = 0.0
        for camera in cameras():
            pixels = touchline.project(camera, points)
            with np.errstate(invalid="ignore"):
                inside = ((pixels >= 0) & (pixels <= camera.image_size_px)).all(axis=1)
            if inside.any():
                rotation = cv2.Rodrigues(camera.R)[0]
                expected, _ = cv2.projectPoints(points[inside], rotation, -camera.R @ camera.C, camera.K, camera.dist)
                worst = max(worst, np.abs(pixels[inside] - expected[:, 0]).max())
        self.assertLess(worst, 1e-9)

    def test_unproject_is_the_inverse(self):
        for camera in cameras():
            pixels = np.random.default_rng(4).uniform((0, 400), (1920, 1080), (200, 2))
            ground = touchline.unproject(camera, pixels)
            seen = np.isfinite(ground).all(axis=1)
            self.assertGreater(seen.sum(), 100)
            np.testing.assert_allclose(touchline.project(camera, ground[seen]), pixels[seen], atol=1e-6)
            raised = touchline.unproject(camera, pixels[seen], height_m=2.44)
            np.testing.assert_allclose(raised[:, 2], 2.44)

    def test_homography_is_the_pinhole(self):
        base = touchline.Base((3.0, -60.0, 18.0), (1280, 720))
        camera = base.camera(12.0, -11.0, 1500.0)
        homography = touchline.homography(camera)
        points = np.array([[0.0, 0.0], [30.0, 20.0], [-10.0, -5.0]])
        mapped = np.column_stack([points, np.ones(3)]) @ homography.T
        self.assertTrue((mapped[:, 2] > 0).all())
        np.testing.assert_allclose(mapped[:, :2] / mapped[:, 2:], touchline.project(camera, points), atol=1e-9)

    def test_shapes_and_strides(self):
        camera = touchline.Base((0.0, -60.0, 18.0), (1280, 720)).camera(0.0, -12.0, 1500.0)
        points = np.random.default_rng(5).uniform(-30, 30, (100, 3))
        expected = touchline.project(camera, points)
        self.assertEqual((expected.shape, expected.dtype), ((100, 2), np.float64))
        for same in (
            np.asfortranarray(points),
            points[::-1][::-1],
            np.column_stack([points, points])[:, :3],
            points.astype(">f8"),
            points.tolist(),
            np.frombuffer(b"\0" + points.tobytes(), np.uint8)[1:].view(np.float64).reshape(100, 3),
        ):
            np.testing.assert_array_equal(touchline.project(camera, same), expected)
        self.assertEqual(touchline.project(camera, points[0]).shape, (2,))
        self.assertEqual(touchline.project(camera, np.zeros((0, 3))).shape, (0, 2))
        self.assertEqual(touchline.project(camera, [[0, -61, 18]]).tolist()[0][0].__class__, float)
        self.assertTrue(np.isnan(touchline.project(camera, [0.0, -70.0, 18.0])).all())
        self.assertTrue(np.isnan(touchline.unproject(camera, [640.0, -5000.0])).all())
        self.assertTrue(np.isnan(touchline.project(camera, [np.nan, 0.0, 0.0])).all())

    def test_many_points_are_the_same_on_several_threads(self):
        camera = touchline.Base((0.0, -60.0, 18.0), (1280, 720), k1=0.1).camera(0.0, -12.0, 1500.0)
        points = np.random.default_rng(6).uniform(-30, 30, (100_000, 3))
        together = touchline.project(camera, points)
        apart = np.vstack([touchline.project(camera, part) for part in np.array_split(points, 10)])
        np.testing.assert_array_equal(together, apart)

    def test_two_points_give_the_camera_back(self):
        marks = touchline.field("soccer").landmarks
        points = np.array([marks["centre_mark"], marks["penalty_area_far_right_front"]])
        found_again = 0
        for camera in cameras(400):
            pixels = touchline.project(camera, points)
            if not ((pixels > 0) & (pixels < camera.image_size_px)).all():
                continue
            found_again += 1
            found = touchline.two_point(camera.base, pixels, points)
            nearest = min(found, key=lambda other: abs(other.focal_px - camera.focal_px))
            self.assertAlmostEqual(nearest.focal_px, camera.focal_px, delta=1e-3)
            np.testing.assert_allclose(nearest.R, camera.R, atol=1e-7)
        self.assertGreater(found_again, 10)

    def test_scores_of_a_camera_with_itself(self):
        base = touchline.Base((0.0, -60.0, 18.0), (1280, 720))
        camera, other = base.camera(10.0, -12.0, 1500.0), base.camera(12.0, -12.0, 1500.0)
        self.assertAlmostEqual(touchline.iou(camera, camera), 1.0)
        self.assertAlmostEqual(touchline.iou(camera, camera, kind="whole"), 1.0)
        self.assertLess(touchline.iou(camera, other), 0.95)
        small = touchline.Base((0.0, -60.0, 18.0), (640, 360)).camera(10.0, -12.0, 750.0)
        with self.assertRaisesRegex(ValueError, "estimate: its pictures have 640 × 360 px"):
            touchline.iou(camera, small)
        lines = touchline.visible_lines(camera)
        self.assertGreater(len(lines), 5)
        self.assertEqual(touchline.jac(camera, lines), 1.0)
        self.assertLess(touchline.jac(other, lines), 0.2)

    def test_fields(self):
        self.assertIn("soccer", touchline.field_names())
        field = touchline.field("soccer", length_m=100.0, width_m=64.0)
        self.assertEqual((field.length_m, field.width_m), (100.0, 64.0))
        np.testing.assert_array_equal(field.landmarks["corner_far_right"], (50.0, 32.0, 0.0))
        circle = field.line("centre_circle", 0.1)
        np.testing.assert_allclose(np.linalg.norm(circle, axis=1), 9.15)
        self.assertLessEqual(np.linalg.norm(np.diff(circle, axis=0), axis=1).max(), 0.1)
        for name in touchline.field_names():
            for line in touchline.field(name).lines:
                self.assertGreaterEqual(len(touchline.field(name).line(line)), 2)


if __name__ == "__main__":
    unittest.main()
