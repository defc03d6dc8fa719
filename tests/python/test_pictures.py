"""Pictures: forests, snapping, tracking, and the camera without a click."""

import json
import os
import shutil
import subprocess
import tempfile
import unittest

import numpy as np
import support
import touchline
from test_documents import demo, far_apart

# What a drawn match of this size needs to be found without a click.
MATCH = ["--frames", "5", "--seed", "3", "--size", "640x360", "--preset", "easy"]


class Forests(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.document = demo()
        touchline.solve(cls.document)
        cls.steps = []
        cls.forest = touchline.Forest.train(cls.document, progress=lambda *step: cls.steps.append(step))
        cls.path = cls.folder.name + "/forest"
        cls.forest.save(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_a_forest_answers_as_what_was_saved(self):
        self.assertEqual(self.forest.cameras, ["main"])
        self.assertTrue(self.steps)
        again = touchline.Forest.load(self.path)
        with self.assertRaisesRegex(touchline.Error, "overwrite=True"):
            again.save(self.path)
        truth = touchline.load(support.DEMO + "/truth.json")
        found = 0
        for index in np.flatnonzero(~self.document.frames.solved)[:6]:
            image = self.document.image(int(index))
            answer = again.relocalize(image)
            same = self.forest.relocalize(image[..., ::-1], bgr=True)
            self.assertEqual(answer.confidence, same.confidence)
            if answer.camera is None:
                self.assertTrue(answer.reason)
                continue
            found += 1
            np.testing.assert_array_equal(answer.camera.K, same.camera.K)
            self.assertEqual(answer.solution.covariance.shape, (3, 3))
            if answer.confidence > 0.9:
                self.assertGreater(touchline.iou(truth.camera(int(index)), answer.camera, truth.field), 0.95)
        self.assertGreater(found, 2)

    def test_what_does_not_fit_is_refused(self):
        with self.assertRaisesRegex(ValueError, "no camera with pictures of this size"):
            self.forest.relocalize(np.zeros((100, 100, 3), np.uint8))
        with self.assertRaisesRegex(KeyError, "no such camera"):
            self.forest.relocalize(self.document.image(0), "other")
        answer = self.forest.relocalize(np.zeros((720, 1280, 3), np.uint8))
        self.assertEqual((answer.camera, answer.confidence), (None, None))
        self.assertTrue(answer.reason)
        self.forest.check_bases(self.document)
        moved = json.loads(self.document.to_json())
        moved["cameras"][0]["position_m"][0] += 1.0
        with self.assertRaisesRegex(touchline.Error, "train the forest again"):
            self.forest.check_bases(touchline.Document.from_json(json.dumps(moved)))
        with open(self.path, "rb") as file:
            damaged = file.read()[:-5]
        with open(self.folder.name + "/damaged", "wb") as file:
            file.write(damaged)
        with self.assertRaisesRegex(touchline.Error, "damaged"):
            touchline.Forest.load(self.folder.name + "/damaged")

    def test_a_reference_that_cannot_be_read_is_a_warning(self):
        lacking = json.loads(self.document.to_json())
        lacking["frames"][0]["image"] = "images/none.jpg"
        document = touchline.Document.from_json(json.dumps(lacking), support.DEMO)
        with self.assertWarnsRegex(UserWarning, "images/none.jpg: "):
            touchline.Forest.train(document, measured=False)

    def test_an_image_whose_size_two_cameras_have_is_given_to_neither(self):
        two = json.loads(self.document.to_json())
        two["cameras"].append({**two["cameras"][0], "id": "second"})
        for frame in [frame for frame in two["frames"] if frame["status"] == "reference"][::2]:
            frame["camera"] = "second"
        forest = touchline.Forest.train(touchline.Document.from_json(json.dumps(two), support.DEMO), measured=False)
        self.assertEqual(sorted(forest.cameras), ["main", "second"])
        image = self.document.image(0)
        with self.assertRaisesRegex(ValueError, r"2 cameras .*\(main, second\).*`camera=`"):
            forest.relocalize(image)
        for name in forest.cameras:
            self.assertTrue(forest.relocalize(image, name))

    @unittest.skipIf(support.NO_PROGRAM, support.NO_PROGRAM)
    def test_forest_and_answers_are_those_of_the_command_line(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(support.DEMO, folder + "/demo")
            self.document.save(folder + "/demo/solved.json")
            support.run("train", folder + "/demo/solved.json", "-o", folder + "/forest")
            with open(folder + "/forest", "rb") as one, open(self.path, "rb") as other:
                self.assertEqual(one.read(), other.read())
            indices = [int(index) for index in np.flatnonzero(~self.document.frames.solved)[:3]]
            images = [folder + "/demo/" + self.document[index]["image"] for index in indices]
            ran = subprocess.run(
                [support.PROGRAM, "relocalize", folder + "/forest", *images, "-o", folder + "/answers.json"],
                capture_output=True, check=False,
            )
            self.assertIn(ran.returncode, (0, 1))
            answers = touchline.load(folder + "/answers.json").frames
            for row, index in enumerate(indices):
                answer = self.forest.relocalize(self.document.image(index))
                self.assertEqual(answer.camera is not None, bool(answers.solved[row]))
                if answer.camera is not None:
                    np.testing.assert_allclose(answer.camera.R, answers.R[row], atol=1e-12)
                    np.testing.assert_allclose(answer.camera.K, answers.K[row], rtol=1e-12)
                    self.assertAlmostEqual(answer.confidence, answers.confidence[row], delta=1e-12)


class Snapping(unittest.TestCase):
    def test_a_camera_is_pulled_onto_the_paint(self):
        document, truth = demo(), touchline.load(support.DEMO + "/truth.json")
        pulled = 0
        for index in range(len(document)):
            true = truth.camera(index)
            near = true.base.camera(true.pan_deg + 0.15, true.tilt_deg - 0.1, true.focal_px * 1.004)
            image = document.image(index)
            try:
                solution = touchline.snap(image, near, document.field)
            except touchline.Error as error:
                self.assertTrue(str(error))
                continue
            pulled += 1
            before, after = (abs(camera.pan_deg - true.pan_deg) for camera in (near, solution.camera))
            self.assertLess(after, before / 2)
        self.assertGreater(pulled, 5)

    def test_a_picture_of_another_size_is_refused(self):
        camera = touchline.load(support.DEMO + "/truth.json").camera(0)
        with self.assertRaisesRegex(ValueError, "scale the picture"):
            touchline.snap(np.zeros((100, 100, 3), np.uint8), camera)


@unittest.skipIf(support.NO_PROGRAM, support.NO_PROGRAM)
class Matches(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        support.run("synth", "-o", cls.folder.name + "/match", *MATCH)
        cls.truth = touchline.load(cls.folder.name + "/match/truth.json")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_a_match_is_calibrated_as_by_the_command_line(self):
        images, folder = self.folder.name + "/match/images", self.folder.name
        support.run("calibrate", images, "-o", folder + "/program", "--found-only")
        # Frames are named by their paths from where the document is begun.
        os.mkdir(folder + "/python")
        here = os.getcwd()
        os.chdir(folder + "/python")
        try:
            document = touchline.calibrate(images, found_only=True)
        finally:
            os.chdir(here)
        document.save(folder + "/python/")
        one, other = (support.read(f"{folder}/{name}/project.json") for name in ("python", "program"))
        self.assertLessEqual(far_apart(one, other), 1e-12)
        frames = document.frames
        self.assertGreater(frames.solved.sum(), 3)
        for index in np.flatnonzero(frames.solved):
            iou = touchline.iou(self.truth.camera(int(index)), document.camera(int(index)), self.truth.field)
            self.assertGreater(iou, 0.97)

    def test_pictures_that_python_decodes_are_calibrated(self):
        class Decoded:
            """Frames that are read when they are asked for."""

            def __init__(self, document):
                self.document, self.asked = document, set()

            def __len__(self):
                return len(self.document)

            def __getitem__(self, index):
                self.asked.add(index)
                return self.document.image(index, bgr=True)

        decoded, steps = Decoded(self.truth), []
        document = touchline.calibrate(
            decoded, bgr=True, name="match.mp4", found_only=True, progress=lambda *step: steps.append(step)
        )
        self.assertEqual(decoded.asked, set(range(len(self.truth))))
        self.assertTrue(steps)
        self.assertEqual(document[3]["video"], {"path": "match.mp4", "frame_index": 3})
        np.testing.assert_allclose(document.base().position_m, self.truth.base().position_m, atol=2.0)

    def test_a_picture_that_cannot_be_read_is_a_warning(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(self.folder.name + "/match/images", folder + "/images")
            for name in sorted(os.listdir(folder + "/images"))[2:]:
                with open(folder + "/images/" + name, "wb") as file:
                    file.write(b"no picture")
            with self.assertWarnsRegex(UserWarning, "0003.jpg: not a PNG"), self.assertRaises(touchline.NoCamera):
                touchline.calibrate(folder + "/images")

    def test_frames_without_a_field_give_no_camera(self):
        noise = np.random.default_rng(7).integers(0, 255, (6, 90, 160, 3), np.uint8)
        with self.assertRaises(touchline.Error) as raised:
            touchline.calibrate(noise)
        self.assertTrue(str(raised.exception))
        # What a decoder raises, or gives in place of a picture, is what the caller sees.
        with self.assertRaisesRegex(TypeError, "dtype uint8"):
            touchline.calibrate([noise[0], "no picture", noise[2]])

    def test_tracking_is_that_of_the_command_line(self):
        folder = self.folder.name + "/clip"
        support.run("synth", "-o", folder, "--frames", "10", "--size", "640x360", "--step", "0.04", "--seed", "4")
        stated = support.read(folder + "/truth.json")
        for index, frame in enumerate(stated["frames"]):
            frame["clip"] = 1
            if index not in (0, 9):
                frame["status"] = "new"
                for key in ("ptz", "solution"):
                    frame.pop(key, None)
                frame["clicks"] = []
            else:
                frame["status"] = "reference"
        with open(folder + "/known.json", "w", encoding="utf-8") as file:
            json.dump(stated, file)
        document = touchline.load(folder + "/known.json")
        report = touchline.track(document, smooth=True)
        self.assertGreater(report.solved, 5)
        document.save(folder + "/python.json")
        support.run("track", folder + "/known.json", "--smooth", "-o", folder + "/program.json")
        one, other = support.read(folder + "/python.json"), support.read(folder + "/program.json")
        self.assertLessEqual(far_apart(one, other), 1e-12)


if __name__ == "__main__":
    unittest.main()
