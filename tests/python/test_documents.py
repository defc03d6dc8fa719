"""Documents: read as columns, changed, written, and solved as the command line does it."""

import copy
import json
import os
import tempfile
import unittest

import numpy as np
import support
import touchline


def demo():
    return touchline.load(support.DEMO)


def far_apart(one, other):
    """The largest difference of two documents without the program that wrote them."""
    one, other = copy.deepcopy(one), copy.deepcopy(other)
    one.pop("generator"), other.pop("generator")
    return support.largest_difference(one, other)


class Reading(unittest.TestCase):
    def test_frames_are_those_of_the_file(self):
        document, stated = demo(), support.read(support.DEMO + "/project.json")
        frames = document.frames
        self.assertEqual(len(document), len(stated["frames"]))
        self.assertEqual(len(frames), len(document))
        self.assertEqual(frames.status.tolist(), [frame["status"] for frame in stated["frames"]])
        # The file has no ids: each frame gets one from its picture.
        self.assertEqual(len(set(frames.id.tolist())), len(document))
        for index, frame in enumerate(stated["frames"]):
            ptz = frame.get("ptz")
            self.assertEqual(bool(frames.solved[index]), ptz is not None)
            for array in (frames.R, frames.C, frames.K, frames.H, frames.dist, frames.ptz):
                self.assertEqual(np.isnan(array[index]).all(), ptz is None)
            if ptz:
                self.assertEqual(frames.ptz[index].tolist(), [ptz["pan_deg"], ptz["tilt_deg"], ptz["focal_px"]])
                covariance = np.array(frame["solution"]["covariance"])
                np.testing.assert_array_equal(frames.sigma[index], np.sqrt(np.diag(covariance)))
                np.testing.assert_array_equal(frames.covariance[index], covariance)
            self.assertEqual(document[index], frames[index])
            self.assertEqual(document[str(frames.id[index])], {"id": frames.id[index], **frame})
        clicks = [click for frame in stated["frames"] for click in frame["clicks"]]
        columns = frames.clicks
        self.assertEqual(columns["image_px"].tolist(), [click["image_px"] for click in clicks])
        self.assertEqual(columns["name"].tolist(), [click.get("landmark") or click.get("line") for click in clicks])
        counts = np.bincount(columns["frame"], minlength=len(document))
        self.assertEqual(counts.tolist(), [len(frame["clicks"]) for frame in stated["frames"]])
        self.assertEqual(document.cameras, stated["cameras"])

    def test_a_frames_camera_is_its_row(self):
        document = demo()
        frames = document.frames
        for index in np.flatnonzero(frames.solved):
            camera = document.camera(int(index))
            np.testing.assert_array_equal(camera.R, frames.R[index])
            np.testing.assert_array_equal(camera.C, frames.C[index])
            np.testing.assert_array_equal(camera.K, frames.K[index])
            np.testing.assert_array_equal(camera.dist, frames.dist[index])
            np.testing.assert_array_equal(touchline.homography(camera), frames.H[index])
        self.assertIsNone(document.camera(int(np.flatnonzero(~frames.solved)[0])))

    def test_a_recovered_journal_is_a_warning(self):
        with tempfile.TemporaryDirectory() as folder:
            demo().save(folder + "/")
            with open(folder + "/project.json.journal", "w", encoding="utf-8") as file:
                file.write("no journal\n")
            with self.assertWarnsRegex(UserWarning, "journal|edits"):
                touchline.load(folder)

    def test_pictures_are_red_first(self):
        document = demo()
        red, blue = document.image(0), document.image(0, bgr=True)
        width, height = document.frames.image_size_px[0]
        self.assertEqual((red.shape, red.dtype), ((height, width, 3), np.uint8))
        np.testing.assert_array_equal(red[..., ::-1], blue)
        # Turf is green, and rather yellow than blue.
        self.assertGreater(red[..., 1].mean(), red[..., 0].mean())
        self.assertGreater(red[..., 0].mean(), red[..., 2].mean())


class Writing(unittest.TestCase):
    def test_what_is_read_is_written_again(self):
        document = demo()
        written = json.loads(document.to_json())["frames"]
        stated = support.read(support.DEMO + "/project.json")["frames"]
        self.assertEqual([frame.pop("id") for frame in written], document.frames.id.tolist())
        self.assertEqual(written, stated)
        with tempfile.TemporaryDirectory() as folder:
            place = f"{folder}/dataset.json"
            document.save(place)
            with self.assertRaisesRegex(touchline.Error, "overwrite=True"):
                document.save(place)
            document.save(place, overwrite=True)
            again = touchline.load(place)
            np.testing.assert_array_equal(again.frames.ptz, document.frames.ptz)
            # The paths lead to the same pictures from there.
            np.testing.assert_array_equal(again.image(0), document.image(0))

    def test_edits_are_saved_and_counted(self):
        with tempfile.TemporaryDirectory() as folder:
            document = demo()
            document.save(f"{folder}/dataset.json")
            document = touchline.load(f"{folder}/dataset.json")
            frame = document.frames.id[1]
            document.set_clicks(frame, [{"landmark": "centre_mark", "image_px": np.array([12.5, 30.25])}])
            document.set_masks(1, np.array([[1, 2, 3, 4]]))
            document.set_status(1, "draft")
            document.save()
            stated = support.read(f"{folder}/dataset.json")["frames"]
            self.assertEqual(stated[1]["clicks"], [{"landmark": "centre_mark", "image_px": [12.5, 30.25]}])
            self.assertEqual((stated[1]["masks_px"], stated[1]["status"]), ([[1.0, 2.0, 3.0, 4.0]], "draft"))
            self.assertEqual([frame.get("revision", 0) for frame in stated[:3]], [0, 1, 0])
            # What is saved once is not counted again.
            document.save()
            self.assertEqual(touchline.load(f"{folder}/dataset.json")[1]["revision"], 1)
            document.set_status(1, "rejected", "blur")
            self.assertEqual(document[1]["reason"], "blur")

    def test_what_another_program_wrote_is_not_lost(self):
        with tempfile.TemporaryDirectory() as folder:
            document = touchline.Document.from_json(demo().to_json(), support.DEMO)
            document.save(f"{folder}/dataset.json")
            self.assertEqual(str(document.path), os.path.realpath(f"{folder}/dataset.json"))
            document.set_status(1, "draft")
            document.save()
            other = touchline.load(f"{folder}/dataset.json")
            other.set_status(2, "draft")
            other.save()
            document.set_status(3, "draft")
            with self.assertRaisesRegex(touchline.Error, "changed by another program"):
                document.save()
            document.save(overwrite=True)
            statuses = touchline.load(f"{folder}/dataset.json").frames.status.tolist()
            self.assertEqual([statuses[index] for index in (1, 2, 3)], ["draft", "new", "draft"])
            np.testing.assert_array_equal(document.image(0), demo().image(0))

    def test_frames_are_a_snapshot(self):
        document = demo()
        before = document.frames
        document.set_status(0, "rejected", "replay")
        self.assertEqual((str(before.status[0]), str(document.frames.status[0])), ("reference", "rejected"))


@unittest.skipIf(support.NO_PROGRAM, support.NO_PROGRAM)
class AsTheCommandLine(unittest.TestCase):
    def test_solve(self):
        document = demo()
        report = touchline.solve(document)
        self.assertEqual((report.solved, report.failed), (9, {}))
        with tempfile.TemporaryDirectory() as folder:
            document.save(f"{folder}/python.json")
            support.run("solve", support.DEMO, "-o", f"{folder}/program.json")
            one, other = support.read(f"{folder}/python.json"), support.read(f"{folder}/program.json")
        self.assertLessEqual(far_apart(one, other), 1e-12)

    def test_estimate_base(self):
        for distortion in ("none", "k1"):
            document = demo()
            touchline.estimate_base(document, distortion=distortion)
            with tempfile.TemporaryDirectory() as folder:
                document.save(f"{folder}/python.json")
                support.run("refine-base", support.DEMO, "-o", f"{folder}/program.json", "--distortion", distortion)
                one, other = support.read(f"{folder}/python.json"), support.read(f"{folder}/program.json")
            self.assertNotEqual(one["cameras"], demo().cameras)
            self.assertLessEqual(far_apart(one, other), 1e-12)

    def test_solve_frame_is_the_solve_of_one_frame(self):
        document = demo()
        touchline.solve(document)
        frames = document.frames
        for index in np.flatnonzero(frames.solved):
            solution = touchline.solve_frame(document.base(), document[int(index)]["clicks"], document.field)
            np.testing.assert_allclose(solution.camera.K, frames.K[index], rtol=1e-12)
            np.testing.assert_allclose(solution.camera.R, frames.R[index], atol=1e-12)
            np.testing.assert_allclose(solution.covariance, frames.covariance[index], rtol=1e-9)
            # Two clicks are no evidence: a document states no rms for them.
            if np.isfinite(frames.rms_px[index]):
                self.assertAlmostEqual(solution.rms_px, frames.rms_px[index], delta=1e-12)
            self.assertEqual(solution.residuals_px.shape[1], 2)

    def test_scores(self):
        truth = touchline.load(support.DEMO + "/truth.json")
        estimate = demo()
        out = json.loads(support.run("evaluate", support.DEMO + "/truth.json", support.DEMO, code=1))
        ids = dict(zip(truth.frames.pictures["image"], truth.frames.id.tolist()))
        solved = [scores for scores in out["frames"] if "iou_part" in scores]
        for scores in solved:
            one, other = truth.camera(ids[scores["frame"]]), estimate.camera(ids[scores["frame"]])
            self.assertAlmostEqual(touchline.iou(one, other, truth.field), scores["iou_part"], delta=1e-12)
            self.assertAlmostEqual(touchline.iou(one, other, truth.field, "whole"), scores["iou_whole"], delta=1e-12)
            annotated = touchline.visible_lines(one, truth.field)
            self.assertAlmostEqual(touchline.jac(other, annotated, estimate.field), scores["jac_5"], delta=1e-12)
        self.assertEqual(len(solved), 9)


class Stopping(unittest.TestCase):
    def test_progress_is_reported(self):
        document, steps = demo(), []
        touchline.solve(document, progress=lambda done, of: steps.append((done, of)))
        self.assertEqual(steps[-1], (len(document), len(document)))

    def test_what_the_callers_function_raises_stops_the_work(self):
        document = demo()
        before = document.to_json()

        def stop(done, of):
            document.set_status(0, "draft")
            raise KeyError(f"{done} of {of}")

        for work in (touchline.solve, touchline.estimate_base):
            document = demo()
            with self.assertRaises(KeyError):
                work(document, progress=stop)
            document.set_status(0, "reference")
            self.assertEqual(document.to_json(), before)


if __name__ == "__main__":
    unittest.main()
