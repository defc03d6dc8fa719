"""Bad input: exceptions that say what, where and how to mend it; no panic, no crash; Ctrl-C."""

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import unittest

import numpy as np
import support
import touchline
from test_documents import demo

# TOUCHLINE_FUZZ_CALLS=100000 in the nightly run.
CALLS = os.environ.get("TOUCHLINE_FUZZ_CALLS", "4000")


class BadInput(unittest.TestCase):
    def refuse(self, kind, text, function, *arguments, **named):
        with self.assertRaisesRegex(kind, text) as raised:
            function(*arguments, **named)
        self.assertNotIn("\n", str(raised.exception))

    def test_arrays(self):
        base = touchline.Base((0.0, -60.0, 18.0), (1280, 720))
        camera = base.camera(0.0, -12.0, 1500.0)
        self.refuse(ValueError, r"points: shape \(N, 3\) or \(N, 2\) is needed, not \[3, 4\]", touchline.project, camera, np.zeros((3, 4)))
        self.refuse(TypeError, "points: an array of numbers is needed, not dtype", touchline.project, camera, ["a", "b"])
        self.refuse(TypeError, "points: an array of numbers is needed", touchline.project, camera, np.zeros(3, complex))
        self.refuse(TypeError, "points: an array of numbers is needed", touchline.project, camera, [[1, 2], [3]])
        self.refuse(ValueError, "position_m: a finite number is needed, not NaN", touchline.Base, (np.nan, 0, 0), (1280, 720))
        self.refuse(ValueError, "a rotation is needed", touchline.Base, (0, 0, 1), (1280, 720), np.ones((3, 3)))
        self.refuse(ValueError, "image_size_px", touchline.Base, (0, 0, 1), (0, 720))
        self.refuse(ValueError, "focal length", base.camera, 0, 0, -1.0)
        self.refuse(ValueError, "two of each", touchline.two_point, base, np.zeros((3, 2)), np.zeros((3, 3)))
        self.refuse(touchline.Error, "2 px are needed", touchline.two_point, base, np.zeros((2, 2)), np.eye(3)[:2])

    def test_images(self):
        camera = touchline.Base((0.0, -60.0, 18.0), (1280, 720)).camera(0.0, -12.0, 1500.0)
        for wrong in (np.zeros((720, 1280)), np.zeros((720, 1280, 4), np.uint8), np.zeros((720, 1280, 3)), "x", None):
            self.refuse(TypeError, r"\(height, width, 3\) and dtype uint8", touchline.snap, wrong, camera)
        self.refuse(ValueError, "sides from 1", touchline.snap, np.zeros((0, 5, 3), np.uint8), camera)

    def test_clicks(self):
        document = demo()
        base = document.base()
        self.refuse(touchline.Error, "no landmark", touchline.solve_frame, base, [{"landmark": "x", "image_px": [1, 2]}])
        self.refuse(ValueError, "missing field `image_px`", touchline.solve_frame, base, [{"landmark": "centre_mark"}])
        self.refuse(ValueError, "no landmark", document.set_clicks, 0, [{"landmark": "x", "image_px": [1, 2]}])
        self.refuse(TypeError, "clicks", document.set_clicks, 0, [object()])
        self.refuse(TypeError, "clicks: .*JSON", document.set_clicks, 0, [{"landmark": "centre_mark", "image_px": [np.nan, 2]}])
        self.refuse(ValueError, "masks_px", document.set_masks, 0, [[1, 2, -3, 4]])
        self.refuse(ValueError, "only a rejected frame", document.set_status, 0, "draft", "blur")
        self.refuse(ValueError, "crown_m: a finite number", touchline.estimate_base, document, crown_m=np.nan)
        self.refuse(IndexError, "27 frames", document.camera, 99)
        self.refuse(KeyError, "no frame of this id", document.camera, "99")

    def test_files(self):
        self.refuse(touchline.Error, "does not exist; give a project folder", touchline.load, "/nonexistent")
        self.refuse(touchline.Error, "there is no such file", touchline.calibrate, "/nonexistent.mp4")
        self.refuse(touchline.Error, "cannot read", touchline.Forest.load, "/nonexistent")
        self.refuse(touchline.Error, "no field template", touchline.field, "x")
        self.refuse(touchline.Error, "outside 90 to 120", touchline.field, length_m=3.0)
        newer = json.loads(demo().to_json())
        newer["version"] = 99
        self.refuse(touchline.Error, "99", touchline.Document.from_json, json.dumps(newer))
        with tempfile.TemporaryDirectory() as folder:
            for name, content in (("empty.mp4", b""), ("text.mp4", b"no video"), ("forest", b"no forest")):
                with open(os.path.join(folder, name), "wb") as file:
                    file.write(content)
            self.refuse(touchline.Error, "empty", touchline.calibrate, os.path.join(folder, "empty.mp4"))
            self.refuse(touchline.Error, "text.mp4", touchline.calibrate, os.path.join(folder, "text.mp4"))
            self.refuse(touchline.Error, "forest", touchline.Forest.load, os.path.join(folder, "forest"))
            unsaved = touchline.Document.from_json(demo().to_json(), folder)
            self.refuse(ValueError, "say where to save", unsaved.save)
            self.refuse(touchline.Error, "there is no such file", unsaved.image, 0)

    @unittest.skipIf(support.NO_PROGRAM, support.NO_PROGRAM)
    def test_texts_are_those_of_the_command_line(self):
        for path in ("/nonexistent", "/etc", support.ROOT + "/README.md"):
            with self.assertRaises(touchline.Error) as raised:
                touchline.load(path)
            ran = subprocess.run([support.PROGRAM, "solve", path], capture_output=True, text=True, check=False)
            self.assertEqual(ran.returncode, 2)
            self.assertIn(str(raised.exception), ran.stderr)


def work_in_a_worker():
    """What a worker of a data loader does."""
    document = demo()
    assert touchline.solve(document).solved == 9
    assert document.frames.R.shape == (27, 3, 3)
    assert touchline.project(document.camera(0), np.ones((100_000, 3))).shape == (100_000, 2)
    assert document.image(0).shape == (720, 1280, 3)


@unittest.skipUnless("fork" in multiprocessing.get_all_start_methods(), "processes cannot be forked here")
class Forked(unittest.TestCase):
    def test_a_forked_process_has_threads_of_its_own(self):
        work_in_a_worker()
        worker = multiprocessing.get_context("fork").Process(target=work_in_a_worker)
        worker.start()
        worker.join(60)
        code = worker.exitcode
        worker.kill()
        self.assertEqual(code, 0)


class Fuzz(unittest.TestCase):
    def test_random_arguments(self):
        here = os.path.dirname(os.path.abspath(__file__))
        ran = subprocess.run(
            [sys.executable, os.path.join(here, "fuzz.py"), CALLS], capture_output=True, text=True, cwd=here, check=False
        )
        self.assertEqual(ran.returncode, 0, ran.stdout[-2000:] + ran.stderr[-4000:])


class Threads(unittest.TestCase):
    def test_ctrl_c_stops_long_work(self):
        script = """
            import signal, sys, touchline
            # A shell lets what it runs in the background ignore Ctrl-C.
            signal.signal(signal.SIGINT, signal.default_int_handler)
            document = touchline.load(sys.argv[1])
            touchline.solve(document)
            try:
                while True:
                    touchline.Forest.train(document, progress=lambda done, of: print("step", flush=True))
            except KeyboardInterrupt:
                print("stopped", flush=True)
        """
        process = subprocess.Popen(
            [sys.executable, "-c", textwrap.dedent(script), support.DEMO], stdout=subprocess.PIPE, text=True
        )
        self.assertEqual(process.stdout.readline(), "step\n")
        process.send_signal(signal.SIGINT)
        begun = time.monotonic()
        rest, _ = process.communicate(timeout=60)
        self.assertTrue(rest.endswith("stopped\n"), rest)
        self.assertLess(time.monotonic() - begun, 10)
        self.assertEqual(process.returncode, 0)

    def test_other_threads_run_meanwhile(self):
        document, counted, is_done = demo(), [0], threading.Event()

        def count():
            while not is_done.is_set():
                counted[0] += 1

        thread = threading.Thread(target=count)
        touchline.solve(document)
        thread.start()
        try:
            touchline.Forest.train(document, trees=1, measured=False)
        finally:
            is_done.set()
            thread.join()
        self.assertGreater(counted[0], 10_000)

    def test_a_decoder_may_use_the_module_on_one_thread(self):
        script = """
            import sys, touchline

            class Frames:
                def __init__(self):
                    self.document = touchline.load(sys.argv[1])

                def __len__(self):
                    return 2

                def __getitem__(self, index):
                    touchline.solve(self.document)
                    touchline.project(self.document.camera(0), [[0.0, 0.0, 0.0]] * 100_000)
                    return self.document.image(index)

            try:
                touchline.calibrate(Frames())
            except touchline.NoCamera as error:
                print(error)
        """
        ran = subprocess.run(
            [sys.executable, "-c", textwrap.dedent(script), support.DEMO],
            capture_output=True, text=True, check=False, timeout=120, env={**os.environ, "RAYON_NUM_THREADS": "1"},
        )
        self.assertIn("use three or more overlapping frames", ran.stdout, ran.stderr)

    def test_many_threads_share_a_document(self):
        document = demo()
        expected = document.frames.ptz

        def read():
            for index in range(40):
                frames = document.frames
                np.testing.assert_array_equal(frames.ptz, expected)
                touchline.project(document.camera(0), np.ones((100, 3)))
                document[index % len(document)]

        threads = [threading.Thread(target=read) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()


if __name__ == "__main__":
    unittest.main()
